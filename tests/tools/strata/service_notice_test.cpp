// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/service_notice.hpp"

#include <cstdlib>
#include <cstring>
#include <string>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/support/test_data.hpp"

namespace strata::tools {
namespace {

/// systemd's end of the socket.
class Manager {
 public:
  explicit Manager(const std::string& name) : socket_(socket(AF_UNIX, SOCK_DGRAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, name.data(), name.size());
    if (name.front() == '@') address.sun_path[0] = '\0';
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), size), 0);
    setenv("NOTIFY_SOCKET", name.c_str(), 1);
  }
  ~Manager() {
    unsetenv("NOTIFY_SOCKET");
    close(socket_);
  }
  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;
  std::string receive() {
    char buffer[64];
    const auto got = recv(socket_, buffer, sizeof buffer, MSG_DONTWAIT);
    return got < 0 ? std::string() : std::string(buffer, static_cast<std::size_t>(got));
  }

 private:
  int socket_;
};

TEST(ServiceNotice, ReachesTheManagerByFileOrAbstractName) {
  const strata::test::TemporaryDirectory folder;
  for (const std::string& name :
       {(folder.path() / "notify").string(), "@strata-test-" + std::to_string(getpid())}) {
    Manager manager(name);
    EXPECT_TRUE(tell_service_manager("READY=1"));
    EXPECT_EQ(manager.receive(), "READY=1");
    EXPECT_TRUE(tell_service_manager("STOPPING=1"));
    EXPECT_EQ(manager.receive(), "STOPPING=1");
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
