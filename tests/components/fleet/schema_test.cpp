// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/schema.hpp"

#include <atomic>
#include <fstream>
#include <iterator>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/fleet/push.hpp"
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

/// As docs/fleet.md has it: the owner makes roles, and is no superuser.
TEST_F(Members, WithANewPasswordLoseWhatAThiefHasSetAndTheThiefIsOut) {
  Connection admin = server_->admin();
  admin.script("CREATE ROLE fleet_admin LOGIN CREATEROLE PASSWORD 'robots-secret'");
  admin.script("CREATE DATABASE fleet OWNER fleet_admin");
  const auto at_fleet = [&](const std::string& role, const std::string& password) {
    std::string url = server_->url(role, password);
    return Connection(url.replace(url.find("/postgres?"), 10, "/fleet?"));
  };
  Connection owner = at_fleet("fleet_admin", test::kPassword);
  (void)apply_schema(owner);
  (void)fleet::add_site(owner, "attic", "map");
  (void)add_member(owner, MemberKind::kRobot, "attic", "r1", test::kPassword);
  Connection thief = at_fleet("attic.r1", test::kPassword);
  for (const char* setting :
       {"SET default_transaction_read_only = on", "IN DATABASE fleet SET statement_timeout = '1ms'",
        "SET row_security = off"}) {
    (void)thief.query("ALTER ROLE \"attic.r1\" " + std::string(setting));
  }
  EXPECT_TRUE(renew_password(owner, MemberKind::kRobot, "attic", "r1", "another").ended_sessions);
  EXPECT_THROW((void)thief.query("ALTER ROLE \"attic.r1\" PASSWORD 'mine'"), LostError);
  EXPECT_THROW((void)at_fleet("attic.r1", test::kPassword), DeniedError);
  EXPECT_EQ(who_am_i(owner).kind, MemberKind::kOwner);
  Connection robot = at_fleet("attic.r1", "another");
  EXPECT_EQ(who_am_i(robot).name, "r1");
  EXPECT_EQ(admin
                .query("SELECT FROM pg_db_role_setting AS s JOIN pg_roles AS r ON r.oid = "
                       "s.setrole WHERE r.rolname = 'attic.r1'")
                .size(),
            0U);
  EXPECT_EQ(admin
                .query("SELECT FROM pg_auth_members AS m JOIN pg_roles AS r ON r.oid = m.roleid "
                       "WHERE r.rolname = 'attic.r1'")
                .size(),
            0U)
      << "the owner is that robot no longer";
}

TEST_F(Members, ThatAreRobotsTakeFewOfTheServersConnections) {
  std::vector<Connection> all;
  for (int i = 0; i < 10; ++i) all.push_back(as("hall.r1"));
  EXPECT_THAT([&] { (void)as("hall.r1"); }, ThrowsMessage<LostError>(HasSubstr("too many")));
  (void)as("hall.r2");
}

/// What it sets of itself takes nothing from sessions of ours.
TEST_F(Members, ThatMadeTheirSessionsReadOnlyStillPush) {
  (void)release_first_tour("hall");
  {
    Connection robot = as("hall.r1");
    for (const char* setting : {"default_transaction_read_only = on", "row_security = off",
                                "default_transaction_isolation = 'serializable'"}) {
      (void)robot.query("ALTER ROLE \"hall.r1\" SET " + std::string(setting));
    }
  }
  test::write_maps(at("maps"), {test::first_tour(), test::drive(10, 1)});
  Connection robot = as("hall.r1");
  std::size_t sent = 0;
  push(robot, "hall", at("maps"),
       [&](const PushedVisit& visit) { sent += visit.outcome == PushOutcome::kSent ? 1 : 0; });
  EXPECT_EQ(sent, 1U);
  EXPECT_EQ(robot.query("SHOW default_transaction_isolation").text(0, 0), "read committed");
}

/// tables_of_november.sql: as `strata fleet init` made them before there was always.sql.
TEST(FleetSchema, TakesOverTablesOfBefore) {
  STRATA_REQUIRE_POSTGRES();
  const test::PostgresServer server;
  Connection admin = server.admin();
  std::ifstream in(STRATA_FLEET_EXAMPLES "/tables_of_november.sql");
  admin.script({std::istreambuf_iterator<char>(in), {}});
  (void)add_site(admin, "hall", "map");
  (void)add_member(admin, MemberKind::kRobot, "hall", "r1", test::kPassword);
  (void)add_member(admin, MemberKind::kOperator, "hall", "ada", test::kPassword);
  const test::TemporaryDirectory folder;
  const std::vector<std::vector<PosedScan>> drives{test::first_tour(), test::drive(10, 1)};
  test::write_maps(folder.path() / "first", {drives[0]}, "first");
  test::write_maps(folder.path() / "maps", drives);
  site::Site site = site::Site::create(folder.path() / "site", "hall", "map", test::ada());
  const std::string hash = site.add(folder.path() / "first", test::ada(), "").status.version.hash;
  site.approve(hash, test::ada(), "");
  Connection ada(server.url("hall.ada", test::kPassword));
  release(ada, site, hash, "");
  Connection robot(server.url("hall.r1", test::kPassword));
  const auto push_outcome = [&] {
    PushOutcome last = PushOutcome::kClash;
    push(robot, "hall", folder.path() / "maps",
         [&](const PushedVisit& visit) { last = visit.outcome; });
    return last;
  };
  EXPECT_EQ(push_outcome(), PushOutcome::kSent) << "a server that nobody brought up to date";
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(apply_schema(admin)) << "it may be done again";
  require_schema(robot);
  EXPECT_EQ(push_outcome(), PushOutcome::kThere);
  EXPECT_EQ(robot.query("SELECT strata.known_runs()").size(), 1U) << "as robots of before ask";
  EXPECT_EQ(robot.query("SELECT strata.known_runs(ARRAY[$1::text])", {maps::visit_hash(drives[0])})
                .size(),
            1U);
  EXPECT_EQ(robot.query("SELECT strata.known_runs(ARRAY['no'])").size(), 0U);
  release(ada, site, hash, "once more");
  EXPECT_EQ(newest_released(robot, "hall")->hash, hash);
}

}  // namespace
}  // namespace strata::fleet
