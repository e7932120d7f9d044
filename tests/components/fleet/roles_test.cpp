// SPDX-License-Identifier: Apache-2.0
/// What a role may do by any statement it likes, as somebody with a stolen password would.
#include <string>

#include <gtest/gtest.h>

#include "components/fleet/schema.hpp"
#include "components/fleet/visits.hpp"
#include "tests/components/fleet/fleet_fixture.hpp"

namespace strata::fleet {
namespace {

class Roles : public test::FleetFixture {
 protected:
  /// Rows, by the letter, of a role that sends this statement; -1: it was refused.
  static std::int64_t rows(Connection& connection, const std::string& sql) {
    try {
      const Rows found = connection.query(sql);
      return sql.starts_with("SELECT") ? static_cast<std::int64_t>(found.size()) : found.changed();
    } catch (const DeniedError&) {
      return kDenied;
    }
  }
  static std::string insert(const std::string& site, const std::string& robot, int visit) {
    return "INSERT INTO strata.visit (site, robot, visit, sha256, format, scans, end_ns, path_m, "
           "payload) VALUES ('" +
           site + "', '" + robot + "', " + std::to_string(visit) +
           ", repeat('a', 64), 1, 1, 1, 1, 'x')";
  }
  /// All that there is of visits, to see that nothing changed.
  [[nodiscard]] std::string all_visits() const {
    Connection admin = server_->admin();
    return admin.query("SELECT string_agg(v::text, ' ' ORDER BY v::text) FROM strata.visit AS v")
        .text(0, 0);
  }
  static constexpr std::int64_t kDenied = -1;
};

TEST_F(Roles, LetARobotAddItsOwnVisitsOnly) {
  Connection robot = as("hall.r1");
  EXPECT_EQ(rows(robot, insert("hall", "r1", 1)), 1);
  EXPECT_EQ(rows(robot, insert("hall", "r2", 1)), kDenied);
  EXPECT_EQ(rows(robot, insert("yard", "r1", 1)), kDenied);
  EXPECT_EQ(rows(robot, insert("yard", "r2", 1)), kDenied);
  // Columns that the server fills in.
  EXPECT_EQ(rows(robot,
                 "INSERT INTO strata.visit (site, robot, visit, sha256, format, scans, end_ns, "
                 "path_m, payload, received_at) VALUES ('hall', 'r1', 2, repeat('a', 64), 1, 1, 1, "
                 "1, 'x', '2001-01-01')"),
            kDenied);
}

TEST_F(Roles, LetNobodyRewriteOrRemoveAVisit) {
  Connection r1 = as("hall.r1");
  Connection r2 = as("hall.r2");
  ASSERT_EQ(rows(r1, insert("hall", "r1", 1)), 1);
  ASSERT_EQ(rows(r2, insert("hall", "r2", 1)), 1);
  const std::string before = all_visits();
  Connection ada = as("hall.ada");
  Connection admin = server_->admin();
  for (Connection* who : {&r1, &r2, &ada, &admin}) {
    SCOPED_TRACE(who->user());
    for (const char* sql :
         {"UPDATE strata.visit SET payload = 'y'", "UPDATE strata.visit SET robot = 'r2'",
          "UPDATE strata.visit SET payload = 'y' WHERE robot = 'r1'", "DELETE FROM strata.visit",
          "DELETE FROM strata.visit WHERE robot = 'r2'", "TRUNCATE strata.visit"}) {
      EXPECT_EQ(rows(*who, sql), kDenied) << sql;
    }
  }
  EXPECT_EQ(rows(r2, insert("hall", "r2", 1) + " ON CONFLICT DO NOTHING"), 0);
  for (const char* conflict : {" ON CONFLICT (site, robot, visit) DO UPDATE SET payload = 'y'"}) {
    EXPECT_EQ(rows(r1, insert("hall", "r1", 1) + conflict), kDenied);
    EXPECT_EQ(rows(r2, insert("hall", "r1", 1) + conflict), kDenied);
  }
  EXPECT_EQ(all_visits(), before);
}

TEST_F(Roles, ShowARobotNothingOfAnotherSiteOrRobot) {
  const std::string hall = release_first_tour("hall");
  const std::string yard = release_first_tour("yard");
  for (const char* who : {"hall.r1", "hall.r2", "yard.r1"}) {
    Connection robot = as(who);
    const Member me = who_am_i(robot);
    ASSERT_EQ(rows(robot, insert(me.site, me.name, 1)), 1);
  }
  Connection robot = as("hall.r1");
  EXPECT_EQ(rows(robot, "SELECT site FROM strata.site"), 1);
  EXPECT_EQ(rows(robot, "SELECT visit FROM strata.visit"), 1) << "its own";
  EXPECT_EQ(rows(robot, "SELECT visit FROM strata.visit WHERE robot = 'r2' OR site = 'yard'"), 0);
  EXPECT_EQ(rows(robot, "SELECT payload FROM strata.visit"), kDenied);
  EXPECT_EQ(rows(robot, "SELECT * FROM strata.visit"), kDenied);
  EXPECT_EQ(rows(robot, "SELECT hash FROM strata.version"), 1);
  EXPECT_EQ(rows(robot, "SELECT hash FROM strata.version WHERE hash = '" + yard + "'"), 0);
  EXPECT_GT(rows(robot, "SELECT path FROM strata.version_file"), 0);
  EXPECT_EQ(rows(robot, "SELECT path FROM strata.version_file WHERE hash <> '" + hall + "'"), 0);
  EXPECT_EQ(rows(robot, "SELECT strata.known_runs()"), 1);
  EXPECT_EQ(rows(robot, "SELECT run FROM strata.known_run"), kDenied);
  EXPECT_EQ(rows(robot, "SELECT robot FROM strata.robot"), kDenied);
  EXPECT_EQ(rows(robot, "SELECT operator FROM strata.operator"), kDenied);
  // What it cannot see it can neither become nor make.
  for (const char* sql :
       {"SET ROLE strata_operator", "SET ROLE \"hall.r2\"", "SET ROLE admin",
        "SET SESSION AUTHORIZATION \"hall.r2\"", "CREATE TABLE strata.mine (x int)",
        "CREATE TABLE public.mine (x int)", "CREATE ROLE mine",
        "ALTER TABLE strata.visit DISABLE ROW LEVEL SECURITY",
        "ALTER TABLE strata.visit DISABLE TRIGGER ALL",
        "INSERT INTO strata.robot (site, robot, role_name) VALUES ('yard', 'r9', 'hall.r1')",
        "UPDATE strata.version SET state = 'withdrawn'",
        "INSERT INTO strata.version (site, hash, runs, facts, note) VALUES ('hall', repeat('b', "
        "64), "
        "'{}', '{}', '')",
        "COPY strata.visit (payload) TO STDOUT", "DROP SCHEMA strata CASCADE"}) {
    EXPECT_EQ(rows(robot, sql), kDenied) << sql;
  }
  // SET ROLE to its own group changes nothing: who logged in counts.
  (void)robot.query("SET ROLE strata_robot");
  EXPECT_EQ(rows(robot, "SELECT visit FROM strata.visit"), 1);
  EXPECT_EQ(rows(robot, insert("hall", "r2", 7)), kDenied);
}

TEST_F(Roles, ShowARobotReleasedVersionsOnly) {
  const std::string hash = release_first_tour("hall");
  Connection robot = as("hall.r1");
  Connection ada = as("hall.ada");
  EXPECT_EQ(rows(robot, "SELECT hash FROM strata.version"), 1);
  (void)ada.query(
      "INSERT INTO strata.version (site, hash, runs, facts, note) VALUES ('hall', repeat('b', 64), "
      "'{}', '{}', '')");
  (void)ada.query(
      "INSERT INTO strata.version_file (site, hash, path, part, payload) VALUES ('hall', "
      "repeat('b', 64), 'a', 0, 'x')");
  EXPECT_EQ(rows(robot, "SELECT hash FROM strata.version"), 1) << "one is loading";
  EXPECT_EQ(rows(robot, "SELECT path FROM strata.version_file WHERE path = 'a'"), 0);
  withdraw(ada, "hall", hash);
  EXPECT_EQ(rows(robot, "SELECT hash FROM strata.version"), 0);
  EXPECT_EQ(rows(robot, "SELECT path FROM strata.version_file"), 0);
  EXPECT_EQ(rows(robot, "SELECT strata.known_runs()"), 1) << "its runs are still nobody's own";
}

TEST_F(Roles, LetAnOperatorDecideForItsSiteAndChangeNoVersion) {
  const std::string hash = release_first_tour("hall");
  (void)release_first_tour("yard");
  Connection robot = as("hall.r1");
  ASSERT_EQ(rows(robot, insert("hall", "r1", 1)), 1);
  Connection yard_robot = as("yard.r1");
  ASSERT_EQ(rows(yard_robot, insert("yard", "r1", 1)), 1);
  Connection ada = as("hall.ada");
  EXPECT_EQ(rows(ada, "SELECT payload FROM strata.visit"), 1);
  EXPECT_EQ(rows(ada, "SELECT hash FROM strata.version"), 1);
  EXPECT_EQ(rows(ada, "SELECT robot FROM strata.robot"), 2);
  EXPECT_EQ(rows(ada, insert("hall", "r1", 9)), kDenied);
  EXPECT_EQ(rows(ada, "UPDATE strata.robot SET set_aside = 'bent'"), 2) << "those of its site";
  EXPECT_EQ(rows(ada, "UPDATE strata.version SET state = 'withdrawn'"), 1) << "that of its site";
  EXPECT_EQ(rows(ada, "UPDATE strata.version SET state = 'released'"), 1);
  const std::string file =
      "INSERT INTO strata.version_file (site, hash, path, part, payload) VALUES ('hall', '" + hash +
      "', 'more', 0, 'x')";
  for (const std::string& sql :
       {file, std::string("UPDATE strata.version SET state = 'loading'"),
        std::string("UPDATE strata.version SET runs = '{}'"),
        std::string("UPDATE strata.version SET state_by = 'hall.r1'"),
        std::string("UPDATE strata.version_file SET payload = 'x'"),
        std::string("DELETE FROM strata.version_file"), std::string("DELETE FROM strata.version"),
        std::string("UPDATE strata.robot SET role_name = 'hall.ada'"),
        std::string("INSERT INTO strata.version (site, hash, runs, facts, note) VALUES ('yard', "
                    "repeat('b', 64), '{}', '{}', '')")}) {
    EXPECT_EQ(rows(ada, sql), kDenied) << sql;
  }
  EXPECT_EQ(ada.query("SELECT state_by FROM strata.version").text(0, 0), "hall.ada");
}

}  // namespace
}  // namespace strata::fleet
