// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/service_notice.hpp"

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/test_data.hpp"
#include "tests/tools/strata/service_manager.hpp"

namespace strata::tools {
namespace {

TEST(ServiceNotice, ReachesTheManagerByFileOrAbstractName) {
  const strata::test::TemporaryDirectory folder;
  for (const std::string& name :
       {(folder.path() / "notify").string(), "@strata-test-" + std::to_string(getpid())}) {
    test::ServiceManager manager(name);
    setenv("NOTIFY_SOCKET", name.c_str(), 1);
    EXPECT_TRUE(tell_service_manager("READY=1"));
    EXPECT_EQ(manager.receive(), "READY=1");
    EXPECT_TRUE(tell_service_manager("STOPPING=1"));
    EXPECT_EQ(manager.receive(), "STOPPING=1");
    unsetenv("NOTIFY_SOCKET");
  }
}

TEST(ServiceNotice, IsNothingOutsideAService) {
  unsetenv("NOTIFY_SOCKET");
  EXPECT_FALSE(tell_service_manager("READY=1"));
  for (const char* name : {"", "@", "/no/such/socket"}) {
    setenv("NOTIFY_SOCKET", name, 1);
    EXPECT_FALSE(tell_service_manager("READY=1")) << name;
  }
  setenv("NOTIFY_SOCKET", std::string(300, 'x').c_str(), 1);
  EXPECT_FALSE(tell_service_manager("READY=1"));
  unsetenv("NOTIFY_SOCKET");
}

}  // namespace
}  // namespace strata::tools
