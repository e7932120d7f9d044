// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/schema.hpp"

#include <atomic>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/components/fleet/fleet_fixture.hpp"

namespace strata::fleet {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(FleetSchema, IsMadeOnceHoweverManyTry) {
  STRATA_REQUIRE_POSTGRES();
  const test::PostgresServer server;
  std::atomic<int> made = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      Connection admin = server.admin();
      if (apply_schema(admin)) ++made;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(made, 1);
  Connection admin = server.admin();
  require_schema(admin);
  EXPECT_TRUE(add_site(admin, "hall", "map"));
  EXPECT_FALSE(add_site(admin, "hall", "map"));
  EXPECT_THAT([&] { (void)add_site(admin, "hall", "odom"); },
              ThrowsMessage<InputError>(HasSubstr("in frame 'map'")));
}

TEST(FleetSchema, ThatIsMissingOrNewerIsTold) {
  STRATA_REQUIRE_POSTGRES();
  const test::PostgresServer server;
  Connection admin = server.admin();
  EXPECT_THAT([&] { require_schema(admin); },
              ThrowsMessage<InputError>(HasSubstr("strata fleet init")));
  (void)apply_schema(admin);
  (void)admin.query("INSERT INTO strata.schema_version (version) VALUES (99)");
  EXPECT_THAT([&] { require_schema(admin); },
              ThrowsMessage<InputError>(HasSubstr("newer Strata (version 99")));
  EXPECT_THROW((void)apply_schema(admin), InputError);
}

class Members : public test::FleetFixture {};

TEST_F(Members, AreWhoTheyAreAndOfOneSite) {
  Connection robot = as("hall.r1");
  EXPECT_EQ(who_am_i(robot).kind, MemberKind::kRobot);
  EXPECT_EQ(who_am_i(robot).name, "r1");
  EXPECT_EQ(require_member(robot, "hall").site, "hall");
  EXPECT_THAT([&] { (void)require_member(robot, "yard"); },
              ThrowsMessage<InputError>(HasSubstr("two sites do not mix")));
  Connection ada = as("yard.ada");
  EXPECT_EQ(who_am_i(ada).kind, MemberKind::kOperator);
  Connection admin = server_->admin();
  EXPECT_EQ(who_am_i(admin).kind, MemberKind::kOwner);
  EXPECT_THAT([&] { (void)require_member(admin, "attic"); },
              ThrowsMessage<InputError>(HasSubstr("there are hall, yard")));
  (void)admin.query("CREATE ROLE stranger LOGIN PASSWORD 'robots-secret'");
  Connection stranger = as("stranger");
  EXPECT_THROW((void)require_member(stranger, "hall"), DeniedError);
}

TEST_F(Members, HaveNamesThatMakeRolesAndAreThereOnce) {
  Connection admin = server_->admin();
  for (const std::string name : {"", "R1", "a.b", "-a", "a b", "robot'; DROP SCHEMA strata; --",
                                 "0123456789012345678901234567890"}) {
    EXPECT_THROW((void)add_member(admin, MemberKind::kRobot, "hall", name, "x"), InputError)
        << name;
  }
  EXPECT_THAT([&] { (void)add_member(admin, MemberKind::kRobot, "hall", "r1", "x"); },
              ThrowsMessage<InputError>(HasSubstr("--new-password")));
  EXPECT_THROW((void)add_member(admin, MemberKind::kRobot, "attic", "r1", "x"), InputError);
}

TEST_F(Members, WithANewPasswordAreNotLetInWithTheOldOne) {
  Connection admin = server_->admin();
  (void)renew_password(admin, MemberKind::kRobot, "hall", "r1", "it's another one");
  EXPECT_THROW((void)as("hall.r1"), DeniedError);
  (void)as("hall.r2");
  Connection robot(server_->url("hall.r1", "it's another one"));
  EXPECT_EQ(who_am_i(robot).name, "r1");
  EXPECT_THROW((void)renew_password(admin, MemberKind::kRobot, "hall", "r9", "x"), InputError);
}

}  // namespace
}  // namespace strata::fleet
