// SPDX-License-Identifier: Apache-2.0
/// A robot whose visits go out and whose maps come in with nobody doing anything.
#include <chrono>
#include <cstdlib>
#include <fstream>

#include "components/fleet/pull.hpp"
#include "components/maps/thinned_runs.hpp"
#include "core/scan/spacing.hpp"
#include "memory/store/coded_visit.hpp"
#include "tests/components/fleet_member/member_fixture.hpp"

namespace strata::fleet_member {
namespace {

using test::drive;

class FleetMemberTest : public test::MemberFixture {
 protected:
  [[nodiscard]] bool is_connected() const {
    fleet::Connection admin = server_->admin();
    return admin.query("SELECT FROM pg_stat_activity WHERE usename = 'hall.r1'").size() > 0;
  }
};

TEST_F(FleetMemberTest, PushesAndPullsByItself) {
  start();
  EXPECT_TRUE(test::comes_true([&] { return active() == newest(); }));
  EXPECT_TRUE(there().empty());
  learn({drive(10, 1)});
  EXPECT_TRUE(test::comes_true([&] { return there().size() == 1; }));
  learn({drive(10, 1), drive(20, 1), drive(30, 1)});
  EXPECT_TRUE(test::comes_true([&] { return there().size() == 3; }));
  const std::string next = release(500);
  EXPECT_TRUE(test::comes_true([&] { return active() == next; }));
  EXPECT_TRUE(comes_to_say("version pulled", next));
  EXPECT_TRUE(comes_to_say("visits sent", "3"));
  EXPECT_EQ(told("visits waiting"), "0");
  EXPECT_NEAR(std::stod(told("clock ahead of the server, s")), 0.0, 1.0);
  EXPECT_EQ(told("level"), "0");
  EXPECT_EQ(told("last error"), "none");
  EXPECT_NE(told("last push, s ago"), "never");
  EXPECT_NE(told("last pull, s ago"), "never");
}

TEST_F(FleetMemberTest, SpacesTheScansThatItPushes) {
  start(", spacing_m: 1.0");
  learn({drive(10, 1)});
  ASSERT_TRUE(test::comes_true([&] { return there().size() == 1; }));
  EXPECT_EQ(there()[0].sha256, maps::visit_hash(spaced(drive(10, 1), {.spacing_m = 1.0})));
  EXPECT_TRUE(comes_to_say("visits waiting", "0"));
}

TEST_F(FleetMemberTest, TellsVisitsRelativeToTheVersionThatItPulled) {
  start(", tolerance_cells: 1.0");
  ASSERT_TRUE(test::comes_true([&] { return active() != "none"; }));
  const auto coding = fleet::active_coding(site::Site(at("robot")), 1.0);
  ASSERT_TRUE(coding.has_value());
  learn({drive(10, 1)});
  ASSERT_TRUE(test::comes_true([&] { return there().size() == 1; }));
  const auto coded = memory::code_visit(drive(10, 1), coding->map, coding->hash, 0.05);
  EXPECT_EQ(there()[0].sha256, maps::visit_hash(coded.value().scans));
  EXPECT_TRUE(comes_to_say("visits waiting", "0"));
  EXPECT_EQ(told("last error"), "none");
}

/// What is told relative to maps that nobody else has could never be read.
TEST_F(FleetMemberTest, SendsVisitsByThemselvesWhereItsVersionIsDamaged) {
  start(", tolerance_cells: 1.0");
  ASSERT_TRUE(test::comes_true([&] { return active() != "none"; }));
  std::ofstream(at("robot") / "active" / "more") << "bytes";
  learn({drive(10, 1)});
  ASSERT_TRUE(test::comes_true([&] { return there().size() == 1; }));
  EXPECT_EQ(there()[0].sha256, maps::visit_hash(drive(10, 1)));
  EXPECT_TRUE(comes_to_say("last error", "is damaged"));
  EXPECT_TRUE(comes_to_say("visits waiting", "0"));
}

TEST_F(FleetMemberTest, LeavesAVersionACandidateUnlessItIsToldMore) {
  start("", "candidate");
  EXPECT_TRUE(comes_to_say("version pulled", newest()));
  EXPECT_EQ(active(), "none");
  EXPECT_EQ(site::Site(at("robot")).find(newest()).state, site::VersionState::kCandidate);
}

TEST_F(FleetMemberTest, DoesNotOverruleWhoGoesBackOnTheRobot) {
  start();
  const std::string first = newest();
  ASSERT_TRUE(test::comes_true([&] { return active() == first; }));
  const std::string second = release(500);
  ASSERT_TRUE(test::comes_true([&] { return active() == second; }));
  ASSERT_TRUE(comes_to_say("version pulled", second));
  (void)site::Site(at("robot")).rollback(test::ada());
  wait_for_a_look();
  EXPECT_EQ(active(), first);
  const std::string third = release(600);
  EXPECT_TRUE(test::comes_true([&] { return active() == third; }));
}

TEST_F(FleetMemberTest, GoesBackWithTheFleet) {
  start();
  const std::string first = newest();
  const std::string second = release(500);
  ASSERT_TRUE(test::comes_true([&] { return active() == second; }));
  fleet::Connection ada = as("hall.ada");
  fleet::release(ada, site::Site(at("hall-site")), first, "the second was bad");
  EXPECT_TRUE(test::comes_true([&] { return active() == first; }));
}

TEST_F(FleetMemberTest, TellsOfAVisitThatTheServerRefusesAndSendsTheRest) {
  learn({drive(10, 1)});
  start();
  ASSERT_TRUE(test::comes_true([&] { return there().size() == 1; }));
  learn({drive(10, 2), drive(20, 2)});
  EXPECT_TRUE(test::comes_true([&] { return there().size() == 2; }));
  EXPECT_TRUE(comes_to_say("message", "look whether a clock was set back"));
  EXPECT_TRUE(comes_to_be("visits refused", "1"));
  EXPECT_TRUE(comes_to_be("visits waiting", "1"));
}

TEST_F(FleetMemberTest, GoesOnPullingWhereAFolderIsInAnotherFrame) {
  test::write_maps(at("maps"), {drive(10, 1)});
  start();
  EXPECT_TRUE(comes_to_say("message", "its frame is its own"));
  EXPECT_EQ(told("level"), "1");
  EXPECT_TRUE(test::comes_true([&] { return active() == newest(); }));
  EXPECT_TRUE(there().empty());
  learn({drive(10, 1)});
  EXPECT_TRUE(test::comes_true([&] { return there().size() == 1; }));
  EXPECT_TRUE(comes_to_say("message", "OK"));
}

TEST_F(FleetMemberTest, DoesNotMixTwoSites) {
  std::filesystem::remove_all(at("robot"));
  (void)site::Site::create(at("robot"), "yard", "map", test::ada());
  start();
  EXPECT_TRUE(comes_to_say("message", "two sites do not mix"));
  EXPECT_EQ(active(), "none");
}

TEST_F(FleetMemberTest, MayBeLedThroughItsLifeAgainAndAgain) {
  learn({drive(10, 1)});
  start();
  for (int i = 0; i < 5; ++i) {
    member().deactivate();
    if (i == 2) {
      member().cleanup();
      member().configure();
    }
    member().activate();
  }
  EXPECT_TRUE(test::comes_true([&] { return there().size() == 1 && active() == newest(); }));
  member().deactivate();
  EXPECT_TRUE(test::comes_true([&] { return !is_connected(); }));
  learn({drive(10, 1), drive(20, 1)});
  for (int look = 0; look < 20; ++look) {  // each takes a connection of ours
    EXPECT_FALSE(is_connected()) << "it rests";
    EXPECT_EQ(there().size(), 1U);
  }
  member().activate();
  EXPECT_TRUE(test::comes_true([&] { return there().size() == 2; }));
}

}  // namespace
}  // namespace strata::fleet_member
