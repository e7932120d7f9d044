// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/push.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/fleet/status.hpp"
#include "components/maps/thinned_runs.hpp"
#include "memory/store/visit_content.hpp"
#include "tests/components/fleet/fleet_fixture.hpp"

namespace strata::fleet {
namespace {

using test::drive;
using test::first_tour;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

class Push : public test::FleetFixture {
 protected:
  std::vector<PushOutcome> outcomes(Connection& connection, const std::string& site,
                                    const std::string& maps) const {
    std::vector<PushOutcome> all;
    push(connection, site, at(maps),
         [&](const PushedVisit& visit) { all.push_back(visit.outcome); });
    return all;
  }
  /// Every bit that comes with a site's visits, in the order they come in.
  [[nodiscard]] std::vector<std::byte> pulled(const std::string& site) const {
    Connection ada = as(site + ".ada");
    std::vector<std::byte> all;
    for_each_visit(ada, site, {}, [&](const VisitName& name, const std::vector<PosedScan>& scans) {
      for (const char c : name.robot + name.sha256) all.push_back(static_cast<std::byte>(c));
      const auto content = memory::visit_content(scans);
      all.insert(all.end(), content.begin(), content.end());
    });
    return all;
  }
};

TEST_F(Push, SendsWhatIsNewAndItsOwnAndNothingTwice) {
  (void)release_first_tour("hall");
  test::write_maps(at("monday"), {first_tour(), drive(10, 1)});
  Connection robot = as("hall.r1");
  EXPECT_THAT(outcomes(robot, "hall", "monday"),
              ElementsAre(PushOutcome::kReleased, PushOutcome::kSent));
  EXPECT_THAT(outcomes(robot, "hall", "monday"),
              ElementsAre(PushOutcome::kReleased, PushOutcome::kThere));
  test::write_maps(at("tuesday"), {first_tour(), drive(10, 1), drive(20, 1)});
  EXPECT_THAT(outcomes(robot, "hall", "tuesday"),
              ElementsAre(PushOutcome::kReleased, PushOutcome::kThere, PushOutcome::kSent));
  const SiteStatus found = status(robot, "hall");
  ASSERT_EQ(found.robots.size(), 1U);
  EXPECT_EQ(found.robots[0].visits, 2);
  EXPECT_GT(found.robots[0].bytes, 0);
  Connection ada = as("hall.ada");
  EXPECT_EQ(status(ada, "hall").robots.size(), 2U);
  EXPECT_EQ(status(ada, "hall").robots[1].visits, 0);
}

/// All that a site ever learned is far more than what lies here.
TEST_F(Push, AsksOnlyForTheRunsThatLieHere) {
  (void)release_first_tour("hall");
  Connection admin = server_->admin();
  admin.script("REVOKE EXECUTE ON FUNCTION strata.known_runs() FROM strata_robot");
  test::write_maps(at("monday"), {first_tour(), drive(10, 1)});
  Connection robot = as("hall.r1");
  EXPECT_THAT(outcomes(robot, "hall", "monday"),
              ElementsAre(PushOutcome::kReleased, PushOutcome::kSent));
}

/// Two drives lost scans when the maps went on: one after it had been sent, one before.
TEST_F(Push, OfWhatIsLeftOfAVisitIsThereWhereTheWholeIs) {
  (void)release_first_tour("hall");
  const auto sent = drive(10, 1);
  const auto unsent = drive(20, 1);
  test::write_maps(at("monday"), {first_tour(), sent});
  Connection robot = as("hall.r1");
  (void)outcomes(robot, "hall", "monday");
  const auto rest = [](std::vector<PosedScan> scans) {
    scans.erase(scans.begin(), scans.begin() + 5);
    return scans;
  };
  test::write_maps(at("later"), {rest(first_tour()), rest(sent), rest(unsent)});
  const std::vector<maps::ThinnedRun> thinned = {
      {0, maps::visit_hash(first_tour()), first_tour().front().scan.stamp.ns},
      {1, maps::visit_hash(sent), sent.front().scan.stamp.ns},
      {2, maps::visit_hash(unsent), unsent.front().scan.stamp.ns},
      {5, "gone", 0}};
  maps::write_thinned_runs(at("later"), thinned);
  EXPECT_THAT(run_hashes(at("later")),
              ElementsAre(thinned[0].visit, thinned[1].visit, thinned[2].visit, "gone"));
  EXPECT_THAT(outcomes(robot, "hall", "later"),
              ElementsAre(PushOutcome::kReleased, PushOutcome::kThere, PushOutcome::kSent));
  EXPECT_THAT(outcomes(robot, "hall", "later"),
              ElementsAre(PushOutcome::kReleased, PushOutcome::kThere, PushOutcome::kThere));
  Connection ada = as("hall.ada");
  const std::vector<VisitName> names = visit_names(ada, "hall");
  ASSERT_EQ(names.size(), 2U);
  EXPECT_EQ(names[0].sha256, thinned[1].visit);
  EXPECT_EQ(names[1].sha256, maps::visit_hash(rest(unsent)));
  EXPECT_EQ(names[1].number, unsent.front().scan.stamp.ns);
}

TEST_F(Push, SpacesWhatItSendsAndKnowsItAgain) {
  (void)release_first_tour("hall");
  const auto long_drive = drive(10, 1);
  test::write_maps(at("monday"), {first_tour(), long_drive});
  Connection robot = as("hall.r1");
  const auto push_spaced = [&](double spacing_m) {
    std::vector<PushedVisit> all;
    push(robot, "hall", at("monday"), [&](const PushedVisit& visit) { all.push_back(visit); },
         {.spacing_m = spacing_m});
    return all.back();
  };
  const PushedVisit sent = push_spaced(1.0);
  EXPECT_EQ(sent.outcome, PushOutcome::kSent);
  const auto expected = spaced(long_drive, {.spacing_m = 1.0});
  ASSERT_LT(expected.size(), long_drive.size());
  EXPECT_EQ(sent.scans, expected.size());
  EXPECT_EQ(sent.name.sha256, maps::visit_hash(expected));
  EXPECT_EQ(sent.whole, maps::visit_hash(long_drive));
  for (const double spacing_m : {1.0, 0.5, 0.0}) {
    EXPECT_EQ(push_spaced(spacing_m).outcome, PushOutcome::kThere) << spacing_m;
  }
  // Another drive of the same begin is another still.
  auto other = drive(10, 2);
  other.pop_back();
  test::write_maps(at("other"), {first_tour(), other});
  EXPECT_THAT(outcomes(robot, "hall", "other"),
              ElementsAre(PushOutcome::kReleased, PushOutcome::kClash));
}

TEST_F(Push, OfEveryScanWorksWithTablesFromBeforeVisitsWereSpaced) {
  (void)release_first_tour("hall");
  Connection admin = server_->admin();
  admin.script("REVOKE SELECT (scans, end_ns) ON strata.visit FROM strata_robot");
  test::write_maps(at("monday"), {first_tour(), drive(10, 1)});
  Connection robot = as("hall.r1");
  EXPECT_THAT(outcomes(robot, "hall", "monday"),
              ElementsAre(PushOutcome::kReleased, PushOutcome::kSent));
  EXPECT_THAT(outcomes(robot, "hall", "monday"),
              ElementsAre(PushOutcome::kReleased, PushOutcome::kThere));
  const auto push_spaced = [&] {
    push(robot, "hall", at("monday"), [](const PushedVisit&) {}, {.spacing_m = 1.0});
  };
  EXPECT_THAT(push_spaced, ThrowsMessage<DeniedError>(HasSubstr("strata fleet init")));
  EXPECT_FALSE(apply_schema(admin)) << "the tables are there";
  push_spaced();
}

TEST_F(Push, RefusesAnotherVisitOfTheSameBeginAndSendsTheRest) {
  (void)release_first_tour("hall");
  Connection robot = as("hall.r1");
  test::write_maps(at("a"), {first_tour(), drive(10, 1)});
  (void)outcomes(robot, "hall", "a");
  test::write_maps(at("b"), {first_tour(), drive(10, 2), drive(20, 2)});
  EXPECT_THAT(outcomes(robot, "hall", "b"),
              ElementsAre(PushOutcome::kReleased, PushOutcome::kClash, PushOutcome::kSent));
  Connection other = as("hall.r2");
  EXPECT_THAT(outcomes(other, "hall", "b"),
              ElementsAre(PushOutcome::kReleased, PushOutcome::kSent, PushOutcome::kSent))
      << "another robot may begin at the same time";
}

TEST_F(Push, RefusesMapsThatAreNotInTheSitesFrame) {
  Connection robot = as("hall.r1");
  test::write_maps(at("own"), {drive(10, 1)});
  EXPECT_THAT([&] { (void)outcomes(robot, "hall", "own"); },
              ThrowsMessage<InputError>(HasSubstr("has no version of the site yet")));
  (void)release_first_tour("hall");
  (void)release_first_tour("yard");
  EXPECT_THAT([&] { (void)outcomes(robot, "hall", "own"); },
              ThrowsMessage<InputError>(HasSubstr("its frame is its own")));
  EXPECT_THAT([&] { (void)outcomes(robot, "yard", "own"); },
              ThrowsMessage<InputError>(HasSubstr("two sites do not mix")));
  Connection ada = as("hall.ada");
  EXPECT_THAT([&] { (void)outcomes(ada, "hall", "own"); },
              ThrowsMessage<InputError>(HasSubstr("visits are robots'")));
  EXPECT_TRUE(visit_names(ada, "hall").empty());
}

/// Ten robots with three visits each, in five orders, at the same time, and some of them twice.
TEST_F(Push, OfTenRobotsGivesTheSameBitsInAnyOrder) {
  std::vector<std::string> robots;
  for (int i = 0; i < 10; ++i) robots.push_back("bot" + std::to_string(i));
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const auto who = static_cast<std::uint64_t>(i + 1);
    std::vector<std::vector<PosedScan>> drives{first_tour()};
    for (int night = 0; night < 3; ++night) {
      drives.push_back(drive(100 + 10 * night, who));
      test::write_maps(at(robots[i] + std::to_string(night)), drives);
    }
  }
  RandomStream random(7, StreamId::kTest);
  std::vector<std::byte> expected;
  for (int round = 0; round < 5; ++round) {
    const std::string site = "site" + std::to_string(round);
    add_site(site);
    (void)release_first_tour(site);
    // Each robot's nights, in a random order of all.
    std::vector<std::pair<std::string, int>> order;
    for (const std::string& robot : robots) {
      add_robot(site, robot);
      for (int night = 0; night < 3; ++night) order.emplace_back(robot, night);
    }
    for (std::size_t i = order.size(); i > 1; --i) {
      std::swap(order[i - 1],
                order[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
    }
    std::vector<std::thread> threads;
    for (std::size_t first = 0; first < 3; ++first) {
      threads.emplace_back([&, first] {
        for (std::size_t i = first; i < order.size(); i += 3) {
          Connection robot = as(site + "." + order[i].first);
          (void)outcomes(robot, site, order[i].first + std::to_string(order[i].second));
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    const std::vector<std::byte> now = pulled(site);
    if (round == 0) expected = now;
    EXPECT_EQ(now == expected, true) << "round " << round;
    Connection ada = as(site + ".ada");
    EXPECT_EQ(visit_names(ada, site).size(), 30U);
  }
  EXPECT_GT(expected.size(), 30U * 20U * 60U);
}

TEST_F(Push, OfARobotThatIsSetAsideIsKeptButNotLearnedFrom) {
  (void)release_first_tour("hall");
  test::write_maps(at("monday"), {first_tour(), drive(10, 1)});
  for (const char* who : {"hall.r1", "hall.r2"}) {
    Connection robot = as(who);
    (void)outcomes(robot, "hall", "monday");
  }
  Connection ada = as("hall.ada");
  EXPECT_EQ(visit_names(ada, "hall").size(), 2U);
  set_aside(ada, "hall", "r2", "its laser is bent");
  ASSERT_EQ(visit_names(ada, "hall").size(), 1U);
  EXPECT_EQ(visit_names(ada, "hall")[0].robot, "r1");
  EXPECT_EQ(status(ada, "hall").robots[1].set_aside, "its laser is bent");
  EXPECT_EQ(status(ada, "hall").robots[1].visits, 1);
  set_aside(ada, "hall", "r2", "");
  EXPECT_EQ(visit_names(ada, "hall").size(), 2U);
  EXPECT_THROW(set_aside(ada, "hall", "r9", "x"), InputError);
}

/// Whoever pushes may push rubbish: it is found, by name, before anything is learned from it.
TEST_F(Push, OfRubbishIsFoundByItsHash) {
  (void)release_first_tour("hall");
  Connection robot = as("hall.r1");
  const auto packed = memory::pack_visit(memory::visit_content(drive(10, 1)));
  (void)robot.query(
      "INSERT INTO strata.visit (site, robot, visit, sha256, format, scans, end_ns, path_m, "
      "payload) VALUES ('hall', 'r1', 7, repeat('a', 64), 1, 1, 1, 1, $1)",
      {std::span<const std::byte>(packed)});
  EXPECT_THAT([&] { (void)pulled("hall"); },
              ThrowsMessage<InputError>(
                  testing::AllOf(HasSubstr("visit 7 of r1"), HasSubstr("its hash does not hold"))));
}

}  // namespace
}  // namespace strata::fleet
