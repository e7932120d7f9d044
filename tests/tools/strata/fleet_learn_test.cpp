// SPDX-License-Identifier: Apache-2.0
/// What an operator's commands of every night do about visits that are wrong, and about versions
/// that were given up.
#include <filesystem>
#include <functional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "components/fleet/push.hpp"
#include "tests/components/fleet/fleet_fixture.hpp"
#include "tests/tools/strata/program.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using nlohmann::json;
using test::Outcome;
using test::quoted;
using testing::HasSubstr;

/// Site "hall" has a version of a simulated day, and `drive` holds another day on top of it.
class FleetNight : public test::FleetFixture {
 protected:
  void SetUp() override {
    FleetFixture::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    ASSERT_EQ(test::run_strata("simulate '" STRATA_SOURCE_DIR
                               "/tools/simulate/scenarios/empty_room.yaml' --set days=2 --per-day "
                               "--quiet --out " +
                               quoted(at("days")))
                  .code,
              0);
    learn_day(1, "", "first");
    site::Site site = site::Site::create(at("site"), "hall", "map", test::ada());
    const std::string hash = site.add(at("first"), test::ada(), "").status.version.hash;
    site.approve(hash, test::ada(), "");
    (void)site.activate(hash, test::ada());
    fleet::Connection ada = as("hall.ada");
    fleet::release(ada, site, hash, "");
    learn_day(2, " --update " + quoted(at("site") / "active"), "drive");
  }
  void learn_day(int day, const std::string& more, const std::string& out) const {
    ASSERT_EQ(
        test::run_strata("learn " + quoted(at("days/day_" + std::to_string(day) + "/log.clf")) +
                         " --quiet --only em" + more + " --out " + quoted(at(out)))
            .code,
        0);
  }
  using Change = std::function<void(PosedScan&, std::size_t)>;
  static void leave(PosedScan&, std::size_t) {}
  /// Of one that does not know how it is turned.
  static void lose(PosedScan& scan, std::size_t i) {
    scan.map_from_robot.theta += i % 2 == 0 ? 1.0 : -2.0;
  }
  /// Of one whose clock is decades ahead of the server's.
  static void put_forward(PosedScan& scan, std::size_t) {
    scan.scan.stamp.ns += 2'500'000'000'000'000'000;
  }
  /// A drive so many hours later; its name.
  std::string push(const std::string& robot, int hours, const Change& change = leave) const {
    const fs::path maps = at(robot + "-" + std::to_string(hours));
    fs::copy(at("drive"), maps, fs::copy_options::recursive);
    {
      memory::Store store(maps / maps::kStoreFile);
      std::vector<PosedScan> scans = store.load_scans(1);
      for (std::size_t i = 0; i < scans.size(); ++i) {
        scans[i].scan.stamp.ns += hours * 3'600'000'000'000;
        change(scans[i], i);
      }
      store.save_scans(1, scans);
    }
    fleet::Connection connection = as("hall." + robot);
    std::string name;
    fleet::push(connection, "hall", maps, [&](const fleet::PushedVisit& visit) {
      if (visit.outcome == fleet::PushOutcome::kSent) {
        name = robot + ":" + std::to_string(visit.name.number);
      }
    });
    return name;
  }
  [[nodiscard]] std::string url(const std::string& who) const {
    return " '" + server_->url("hall." + who, test::kPassword) + "' ";
  }
  [[nodiscard]] json ask(const std::string& words) const {
    const Outcome outcome = test::run_strata(words + " --json 2>" + quoted(at("notes")));
    EXPECT_EQ(outcome.code, 0) << words << "\n" << test::bytes_of(at("notes"));
    return json::parse(outcome.out, nullptr, false);
  }
  [[nodiscard]] std::string learn(const std::string& out) const {
    return "fleet learn" + url("ada") + quoted(at("site")) + " --quiet --out " + quoted(at(out));
  }
  [[nodiscard]] std::int64_t set_aside() const {
    fleet::Connection admin = server_->admin();
    return admin.query("SELECT count(set_aside) FROM strata.robot").integer(0, 0);
  }
};

TEST_F(FleetNight, LeavesALostVisitOutAndLearnsTheRobotsOthers) {
  (void)push("r1", 0);
  (void)push("r1", 1);
  const std::string lost = push("r1", 2, lose);
  (void)push("r2", 3);
  const json learned = ask(learn("together"));
  EXPECT_EQ(learned["visits"], 3);
  EXPECT_EQ(learned["robots"], json({"r1", "r2"}));
  ASSERT_EQ(learned["left_out"].size(), 1U);
  EXPECT_EQ(learned["left_out"][0]["visit"], lost);
  EXPECT_THAT(learned["left_out"][0]["why"].get<std::string>(),
              HasSubstr("of its scans contradict the active version"));
  EXPECT_EQ(set_aside(), 0);
  EXPECT_THAT(test::run_strata(learn("again") + " 2>&1").out,
              HasSubstr("visit " + lost + " is left out: "));
  EXPECT_EQ(ask(learn("by-hand") + " --unchecked --without " + lost)["visits"], 3);
  EXPECT_TRUE(test::bytes_of(at("by-hand/strata.db")) == test::bytes_of(at("together/strata.db")));
  EXPECT_THAT(test::run_strata(learn("no") + " --without r1:7 2>&1").out,
              HasSubstr("is no visit that would be learned"));
}

TEST_F(FleetNight, LeavesAVisitOutThatCannotBeRead) {
  const std::string damaged = push("r1", 0);
  (void)push("r2", 1);
  fleet::Connection admin = server_->admin();
  (void)admin.query("SET session_replication_role = replica");  // no trigger forbids it
  (void)admin.query("UPDATE strata.visit SET sha256 = repeat('a', 64) WHERE robot = 'r1'");
  const json learned = ask(learn("together"));
  EXPECT_EQ(learned["robots"], json({"r2"}));
  ASSERT_EQ(learned["left_out"].size(), 1U);
  EXPECT_EQ(learned["left_out"][0]["visit"], damaged);
  EXPECT_THAT(test::bytes_of(at("notes")), HasSubstr("its hash does not hold"));
}

TEST_F(FleetNight, TakesTheServersClockForWrongWhereMostRobotsAreAhead) {
  (void)push("r1", 0, put_forward);
  (void)push("r2", 1, put_forward);
  const Outcome outcome = test::run_strata(learn("together") + " 2>&1");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.out, HasSubstr("its own clock was behind"));
  EXPECT_EQ(set_aside(), 0);
  EXPECT_EQ(ask(learn("together") + " --unchecked")["visits"], 2);
}

TEST_F(FleetNight, LeavesTheVisitOfAWrongClockOutAndThrowsWhereNoneIsLeft) {
  const std::string ahead = push("r1", 0, put_forward);
  EXPECT_EQ(test::run_strata(learn("none") + " 2>&1").code, 2);
  EXPECT_EQ(set_aside(), 1) << "it is all that this robot ever sent";
  fleet::Connection admin = server_->admin();
  (void)admin.query("UPDATE strata.robot SET set_aside = NULL");
  (void)push("r1", 1);
  (void)push("r1", 2);
  (void)push("r2", 3);
  const json learned = ask(learn("together"));
  EXPECT_EQ(learned["visits"], 3);
  ASSERT_EQ(learned["left_out"].size(), 1U);
  EXPECT_EQ(learned["left_out"][0]["visit"], ahead);
  EXPECT_EQ(set_aside(), 0);
}

TEST_F(FleetNight, ReleasesWhatIsActiveOnceAndGivesNothingUpAgain) {
  const std::string night = "fleet release" + url("ada") + quoted(at("site")) + " active";
  EXPECT_EQ(ask(night)["is_new"], false);
  site::Site site(at("site"));
  const std::string second = site.add(at("drive"), test::ada(), "").status.version.hash;
  site.approve(second, test::ada(), "");
  (void)site.activate(second, test::ada());
  EXPECT_EQ(ask(night)["is_new"], true);
  fleet::Connection ada = as("hall.ada");
  const auto newest = [&] { return fleet::newest_released(ada, "hall")->hash; };
  const Outcome by_hand =
      test::run_strata("fleet release" + url("ada") + quoted(at("site")) + " 1 2>&1");
  EXPECT_EQ(by_hand.code, 0) << by_hand.out;
  EXPECT_NE(newest(), second);
  const Outcome again = test::run_strata(night + " 2>&1");
  EXPECT_EQ(again.code, 2);
  EXPECT_THAT(again.out, HasSubstr("another one was released"));
  EXPECT_NE(newest(), second) << "somebody went back";
  EXPECT_EQ(ask(night + " --again")["is_new"], true);
  EXPECT_EQ(newest(), second);
  (void)site::Site::create(at("robot"), "hall", "map", test::ada());
  const std::string pull = "fleet pull" + url("r1") + quoted(at("robot")) + " --activate --keep 0";
  EXPECT_EQ(ask(pull)["removed"], json::array());
  EXPECT_EQ(site::Site(at("robot")).active(), second);
}

}  // namespace
}  // namespace strata::tools
