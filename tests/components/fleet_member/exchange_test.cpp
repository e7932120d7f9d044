// SPDX-License-Identifier: Apache-2.0
#include "components/fleet_member/exchange.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/settings/config_reader.hpp"

namespace strata::fleet_member {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(WaitAfter, DoublesUpToABound) {
  const RetryConfig retry{.first_s = 5.0, .longest_s = 60.0};
  EXPECT_DOUBLE_EQ(wait_after(1, retry, 1.0).count(), 5.0);
  EXPECT_DOUBLE_EQ(wait_after(2, retry, 1.0).count(), 10.0);
  EXPECT_DOUBLE_EQ(wait_after(4, retry, 1.0).count(), 40.0);
  EXPECT_DOUBLE_EQ(wait_after(5, retry, 1.0).count(), 60.0);
  EXPECT_DOUBLE_EQ(wait_after(1'000'000'000'000, retry, 1.0).count(), 60.0);
  EXPECT_DOUBLE_EQ(wait_after(5, retry, 0.0).count(), 30.0) << "robots come one by one";
}

FleetMemberConfig read(const std::string& text) {
  return settings::read_config<FleetMemberConfig>(YAML::Load(text), "test");
}

TEST(FleetMemberConfig, TakesNoPassword) {
  const std::string rest = ", site: hall, maps: [maps]}";
  EXPECT_EQ(
      read("{server: 'postgresql://hall.r1@server:5432/fleet?sslmode=verify-full'" + rest).site,
      "hall");
  for (const char* url : {"postgresql://hall.r1:secret@server/fleet",
                          "postgresql://hall.r1@server/fleet?password=secret",
                          "host=server user=hall.r1 password=secret"}) {
    EXPECT_THAT([&] { (void)read("{server: '" + std::string(url) + "'" + rest); },
                ThrowsMessage<ConfigError>(HasSubstr("has a password in it")));
  }
}

TEST(FleetMemberConfig, WantsSomethingToDo) {
  EXPECT_THAT([] { (void)read("{server: 'postgresql://a@b/c', site: hall}"); },
              ThrowsMessage<ConfigError>(HasSubstr("there is nothing to do")));
  EXPECT_THROW((void)read("{server: 'postgresql://a@b/c', maps: [maps]}"), ConfigError);
  EXPECT_THROW((void)read("{site: hall, maps: [maps]}"), ConfigError);
}

}  // namespace
}  // namespace strata::fleet_member
