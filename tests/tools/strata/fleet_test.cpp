// SPDX-License-Identifier: Apache-2.0
/// `strata fleet`, as an integrator calls it: from one robot to two that share what they learn.
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/components/fleet/postgres_server.hpp"
#include "tests/components/site/small_maps.hpp"
#include "tests/tools/strata/program.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using nlohmann::json;
using test::Outcome;
using test::quoted;
using testing::HasSubstr;
using testing::Not;

class FleetVerb : public testing::Test {
 protected:
  void SetUp() override {
    STRATA_REQUIRE_POSTGRES();
    server_.emplace();
    std::ofstream(at("secret")) << "robots-secret\n";
  }
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }
  [[nodiscard]] std::string url(const std::string& role = "admin") const {
    return "'" + server_->url(role, role == "admin" ? "admin secret" : "robots-secret") + "'";
  }
  static Outcome run(const std::string& words) { return test::run_strata(words + " 2>&1"); }
  static json ask(const std::string& words) {
    const Outcome outcome = test::run_strata(words + " --json");
    EXPECT_EQ(outcome.code, 0) << words << "\n" << outcome.out;
    return json::parse(outcome.out, nullptr, false);
  }
  [[nodiscard]] Outcome learn(const std::string& words) const {
    return run("learn --quiet " + words + " --only em");
  }
  [[nodiscard]] std::string day(int number) const {
    return quoted(at("days/day_" + std::to_string(number) + "/log.clf"));
  }
  void add_member(const std::string& kind, const std::string& name) const {
    EXPECT_EQ(run("fleet add-" + kind + " " + url() + " --site hall-3 " + name +
                  " --password-file " + quoted(at("secret")))
                  .code,
              0);
  }
  test::TemporaryDirectory folder_;
  std::optional<test::PostgresServer> server_;
};

/// The visit of a robot that does not know how it is turned.
void make_lost(const fs::path& maps) {
  memory::Store store(maps / maps::kStoreFile);
  std::vector<PosedScan> scans = store.load_scans(1);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    scans[i].map_from_robot.theta += i % 2 == 0 ? 1.0 : -2.0;
  }
  store.save_scans(1, scans);
}

/// The visit of a robot whose clock is decades ahead.
void put_forward(const fs::path& maps) {
  memory::Store store(maps / maps::kStoreFile);
  std::vector<PosedScan> scans = store.load_scans(1);
  for (PosedScan& scan : scans) scan.scan.stamp.ns += 2'500'000'000'000'000'000;
  store.save_scans(1, scans);
}

TEST_F(FleetVerb, LeadsFromOneRobotToTwoThatShareWhatTheyLearn) {
  ASSERT_EQ(run("simulate '" STRATA_SOURCE_DIR
                "/tools/simulate/scenarios/empty_room.yaml' --set days=3 --per-day --quiet --out " +
                quoted(at("days")))
                .code,
            0);
  // The first robot's maps are the site's first version.
  ASSERT_EQ(learn(day(1) + " --out " + quoted(at("maps"))).code, 0);
  EXPECT_EQ(ask("site init " + quoted(at("site")) + " --id hall-3")["mapId"], "hall-3");
  const std::string first =
      ask("site add " + quoted(at("site")) + " " + quoted(at("maps")))["mapHash"];
  EXPECT_EQ(run("site approve " + quoted(at("site")) + " 1 --unchecked").code, 0);
  EXPECT_EQ(run("site activate " + quoted(at("site")) + " 1").code, 0);
  EXPECT_EQ(ask("fleet init " + url() + " --site hall-3")["made_tables"], true);
  EXPECT_EQ(ask("fleet init " + url() + " --site hall-3")["made_site"], false);
  for (const char* robot : {"r1", "r2"}) add_member("robot", robot);
  add_member("operator", "ada");
  EXPECT_EQ(
      ask("fleet release " + url("hall-3.ada") + " " + quoted(at("site")) + " active")["mapHash"],
      first);
  // Each robot takes it, learns a day of its own, and tells the others.
  for (int robot = 1; robot <= 2; ++robot) {
    const std::string own = "robot" + std::to_string(robot);
    const std::string role = url("hall-3.r" + std::to_string(robot));
    EXPECT_EQ(run("site init " + quoted(at(own)) + " --id hall-3").code, 0);
    const json pulled = ask("fleet pull " + role + " " + quoted(at(own)) + " --activate");
    EXPECT_EQ(pulled["state"], "active");
    EXPECT_EQ(pulled["mapHash"], first);
    ASSERT_EQ(learn(day(1 + robot) + " --update " + quoted(at(own) / "active") + " --out " +
                    quoted(at(own + "-maps")))
                  .code,
              0);
    const std::string push =
        "fleet push " + role + " " + quoted(at(own + "-maps")) + " --site hall-3";
    const json pushed = ask(push);
    ASSERT_EQ(pushed["visits"].size(), 2U);
    EXPECT_EQ(pushed["visits"][0]["outcome"], "released") << "run 0 came bit for bit with the maps";
    EXPECT_EQ(pushed["visits"][1]["outcome"], "sent");
    EXPECT_EQ(ask(push)["visits"][1]["outcome"], "there");
  }
  // A third one is lost, and a fourth one's clock is wrong.
  for (const std::string& robot : {std::string("3"), std::string("4")}) {
    add_member("robot", "r" + robot);
    const fs::path maps = at("robot" + robot + "-maps");
    fs::copy(at("robot2-maps"), maps, fs::copy_options::recursive);
    robot == "3" ? make_lost(maps) : put_forward(maps);
    const json pushed = ask("fleet push " + url("hall-3.r" + robot) + " " + quoted(maps) +
                            " --site hall-3 --against " + quoted(at("robot2")));
    EXPECT_EQ(pushed["visits"][1]["outcome"], "sent");
    EXPECT_EQ(pushed["visits"][1]["relative_to"], first);
    EXPECT_NEAR(pushed["clock_ahead_s"], 0.0, 1.0);
  }
  // What both saw becomes the next version.
  const json learned = ask("fleet learn " + url("hall-3.ada") + " " + quoted(at("site")) +
                           " --quiet --out " + quoted(at("together")));
  EXPECT_EQ(learned["visits"], 2);
  EXPECT_EQ(learned["robots"], json({"r1", "r2"}));
  EXPECT_EQ(learned["runs"], 3);
  ASSERT_EQ(learned["checked"].size(), 4U);
  EXPECT_EQ(learned["checked"][0]["robot"], "r4");
  EXPECT_THAT(learned["checked"][0]["set_aside"].get<std::string>(),
              HasSubstr("its clock was ahead"));
  EXPECT_EQ(learned["checked"][1]["set_aside"], nullptr);
  EXPECT_EQ(learned["checked"][2]["set_aside"], nullptr);
  EXPECT_THAT(learned["checked"][3]["set_aside"].get<std::string>(),
              HasSubstr("of its scans contradict the active version"));
  EXPECT_THAT(run("fleet status " + url("hall-3.ada") + " --site hall-3").out,
              HasSubstr("r3: 1 visits"));
  EXPECT_THAT(run("fleet status " + url("hall-3.ada") + " --site hall-3").out,
              HasSubstr("SET ASIDE: by learn: "));
  // Pushed in the other order: the same store, bit for bit.
  fleet::Connection admin = server_->admin();
  (void)admin.query("SET session_replication_role = replica");  // no trigger forbids it
  (void)admin.query("DELETE FROM strata.visit");
  for (const char* robot : {"2", "1"}) {
    (void)ask("fleet push " + url("hall-3.r" + std::string(robot)) + " " +
              quoted(at("robot" + std::string(robot) + "-maps")) + " --site hall-3");
  }
  (void)ask("fleet learn " + url("hall-3.ada") + " " + quoted(at("site")) + " --quiet --out " +
            quoted(at("again")));
  EXPECT_TRUE(test::bytes_of(at("again/strata.db")) == test::bytes_of(at("together/strata.db")));
  const json added = ask("site add " + quoted(at("site")) + " " + quoted(at("together")));
  EXPECT_EQ(run("site approve " + quoted(at("site")) + " 2 --log " + day(3)).code, 0);
  EXPECT_EQ(run("fleet release " + url("hall-3.ada") + " " + quoted(at("site")) + " 2").code, 0);
  const json pulled =
      ask("fleet pull " + url("hall-3.r1") + " " + quoted(at("robot1")) + " --activate");
  EXPECT_EQ(pulled["mapHash"], added["mapHash"]);
  EXPECT_EQ(pulled["is_new"], true);
  const json status = ask("fleet status " + url("hall-3.ada") + " --site hall-3");
  EXPECT_EQ(status["robots"].size(), 4U);
  EXPECT_EQ(status["robots"][1]["visits"], 1);
  EXPECT_EQ(status["versions"].size(), 2U);
  EXPECT_THAT(run("fleet status " + url("hall-3.r1") + " --site hall-3").out,
              HasSubstr("asked as robot hall-3.r1"));
}

TEST_F(FleetVerb, SaysWhatIsWrongAndWhatToDo) {
  const auto expect = [](const Outcome& outcome, int code, const std::string& text) {
    EXPECT_EQ(outcome.code, code) << outcome.out;
    EXPECT_THAT(outcome.out, HasSubstr(text));
    EXPECT_THAT(outcome.out, HasSubstr("; ")) << "no remedy";
    EXPECT_THAT(outcome.out, Not(HasSubstr("secret")));
  };
  const std::string site = " --site hall-3";
  expect(run("fleet status " + url() + site), 2, "strata fleet init");
  expect(run("fleet status 'postgresql://admin:secret@/fleet?host=/nowhere'" + site), 1,
         "cannot be reached");
  expect(run("fleet status 'http://admin:secret@host/'" + site), 2,
         "is none of a PostgreSQL server");
  expect(run("fleet status '" + server_->url("admin", "wrong-secret") + "'" + site), 2,
         "check user, password and database");
  expect(run("fleet init " + url() + " --site 'Hall 3'"), 2, "'Hall 3' is none");
  ASSERT_EQ(run("fleet init " + url() + site).code, 0);
  expect(run("fleet status " + url() + " --site attic"), 2, "has no site 'attic'");
  const json made = ask("fleet add-robot " + url() + site + " r1");
  EXPECT_EQ(made["password"].get<std::string>().size(), 32U);
  EXPECT_THAT(made["url"].get<std::string>(), HasSubstr("postgresql://hall-3.r1@/postgres?host="));
  expect(run("fleet add-robot " + url() + site + " r1"), 2, "has a role hall-3.r1 already");
  add_member("robot", "r2");
  const std::string r2 = url("hall-3.r2");
  expect(run("fleet push " + r2 + " " + quoted(at("nothing")) + site), 2, "is missing");
  test::write_small_maps(at("maps"), "a");
  expect(run("fleet push " + r2 + " " + quoted(at("maps")) + site), 2,
         "has no version of the site yet");
  EXPECT_EQ(run("site init " + quoted(at("yard")) + " --id yard").code, 0);
  expect(run("fleet push " + r2 + " " + quoted(at("maps")) + site + " --against " +
             quoted(at("yard"))),
         2, "two sites do not mix");
  expect(run("fleet push " + r2 + " " + quoted(at("maps")) + site + " --tolerance 1"), 2,
         "--against");
  expect(run("fleet push " + r2 + " " + quoted(at("maps")) + " --site yard"), 2,
         "two sites do not mix");
  expect(run("fleet set-aside " + url() + site + " r2"), 2, "says not why");
  expect(run("fleet pull " + r2 + " " + quoted(at("yard"))), 2, "two sites do not mix");
  EXPECT_EQ(run("site init " + quoted(at("hall")) + " --id hall-3").code, 0);
  EXPECT_THAT(run("fleet pull " + r2 + " " + quoted(at("hall"))).out,
              HasSubstr("no version was released yet"));
  expect(run("fleet learn " + url() + " " + quoted(at("hall")) + " --out " + quoted(at("out"))), 2,
         "no version 'active'");
  EXPECT_FALSE(fs::exists(at("out")));
  server_->kill_hard();
  expect(run("fleet status " + r2 + site), 1, "cannot be reached");
  server_->start();
  EXPECT_EQ(run("fleet status " + r2 + site).code, 0);
}

TEST(FleetWithoutItsLibrary, SaysWhatToInstallAndEveryOtherVerbWorks) {
  const test::TemporaryDirectory folder;
  std::ofstream(folder.path() / "libpq.so.5") << "no library\n";
  const std::string prefix = "LD_LIBRARY_PATH=" + quoted(folder.path());
  const Outcome outcome = test::run_strata_under(
      prefix, "fleet status postgresql://robot@localhost/fleet --site hall-3 2>&1");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.out, HasSubstr("libpq.so.5: cannot be loaded: "));
  EXPECT_THAT(outcome.out, HasSubstr("Debian: libpq5"));
  EXPECT_EQ(test::run_strata_under(prefix, "--version").code, 0);
}

}  // namespace
}  // namespace strata::tools
