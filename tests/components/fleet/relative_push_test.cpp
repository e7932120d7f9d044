// SPDX-License-Identifier: Apache-2.0
/// Visits that are told relative to a version, from a robot to who learns from them.
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/fleet/push.hpp"
#include "components/fleet/visits.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/maps/thinned_runs.hpp"
#include "memory/store/coded_visit.hpp"
#include "memory/store/visit_content.hpp"
#include "tests/components/fleet/fleet_fixture.hpp"

namespace strata::fleet {
namespace {

using test::drive;
using test::first_tour;
using testing::HasSubstr;
using testing::ThrowsMessage;

class RelativePush : public test::FleetFixture {
 protected:
  [[nodiscard]] site::Site local_with_active(const std::string& hash) const {
    site::Site local(at("hall-site"));
    (void)local.activate(hash, test::ada());
    return local;
  }
};

/// The version is the site's first, whose map is small: nearly all is told by value.
TEST_F(RelativePush, TellsVisitsRelativeToAReleasedVersionAndKnowsThemAgain) {
  const std::string hash = release_first_tour("hall");
  const auto coding = active_coding(local_with_active(hash), 1.0);
  ASSERT_TRUE(coding.has_value());
  test::write_maps(at("monday"), {first_tour(), drive(10, 1)});
  Connection robot = as("hall.r1");
  const auto pushed = [&](const Coding* relative_to) {
    std::vector<PushedVisit> all;
    push(
        robot, "hall", at("monday"), [&](const PushedVisit& visit) { all.push_back(visit); }, {},
        relative_to);
    return all.back();
  };
  const PushedVisit sent = pushed(&*coding);
  EXPECT_EQ(sent.outcome, PushOutcome::kSent);
  EXPECT_EQ(sent.relative_to, hash);
  const auto coded = memory::code_visit(drive(10, 1), coding->map, hash, 0.05);
  ASSERT_TRUE(coded.has_value());
  EXPECT_EQ(sent.name.sha256, maps::visit_hash(coded->scans));
  EXPECT_EQ(sent.bytes, coded->bytes.size());
  for (const Coding* later : {&*coding, static_cast<const Coding*>(nullptr)}) {
    EXPECT_EQ(pushed(later).outcome, PushOutcome::kThere);
  }
  // An operator without that version has it from the server.
  Connection ada = as("hall.ada");
  const auto learned = visits_to_learn(ada, "hall", {});
  ASSERT_EQ(learned.size(), 1U);
  EXPECT_EQ(memory::visit_content(learned[0].scans), memory::visit_content(coded->scans));
}

/// Another machine makes another last bit of the same way; another way to the same end is another
/// visit.
TEST_F(RelativePush, KnowsAVisitAgainByItsWayButNotToTheLastBit) {
  (void)release_first_tour("hall");
  Connection robot = as("hall.r1");
  for (const auto& [day, factor, outcome] : {std::tuple(1, 1.0 + 1e-12, PushOutcome::kThere),
                                             std::tuple(2, 1.01, PushOutcome::kClash)}) {
    const std::string maps = at("day_" + std::to_string(day));
    test::write_maps(maps, {first_tour(), drive(10 * day, 1)});
    const memory::Store store = maps::open_for_reading(maps);
    const Visit visit = visit_of(store, store.runs_with_scans().back());
    (void)robot.query(
        "INSERT INTO strata.visit (site, robot, visit, sha256, format, scans, end_ns, path_m, "
        "payload) VALUES ('hall', 'r1', $1, repeat($2, 64), 2, $3, $4, $5, 'told')",
        {visit.name.number, std::to_string(day), visit.scans, visit.end_ns, factor * visit.path_m});
    std::vector<PushedVisit> all;
    push(robot, "hall", maps, [&](const PushedVisit& one) { all.push_back(one); });
    EXPECT_EQ(all.back().outcome, outcome) << factor;
  }
}

TEST_F(RelativePush, SendsVisitsByThemselvesWhereTheServerLacksTheVersion) {
  (void)release_first_tour("hall");
  test::write_maps(at("monday"), {first_tour(), drive(10, 1)});
  Connection robot = as("hall.r1");
  const Coding own{std::string(64, 'b'), make_reflection_grid(0.05, {{0, 0}, {9, 9}})};
  std::vector<PushedVisit> all;
  push(
      robot, "hall", at("monday"), [&](const PushedVisit& visit) { all.push_back(visit); }, {},
      &own);
  EXPECT_EQ(all.back().outcome, PushOutcome::kSent);
  EXPECT_EQ(all.back().relative_to, "");
  EXPECT_EQ(all.back().name.sha256, maps::visit_hash(drive(10, 1)));
}

TEST_F(RelativePush, OfAVisitRelativeToAVersionThatNobodyHasIsNamedAndStays) {
  (void)release_first_tour("hall");
  const std::string hash(64, 'b');
  const auto coded =
      memory::code_visit(drive(10, 1), make_reflection_grid(0.05, {{0, 0}, {9, 9}}), hash, 0.05);
  ASSERT_TRUE(coded.has_value());
  Connection robot = as("hall.r1");
  (void)robot.query(
      "INSERT INTO strata.visit (site, robot, visit, sha256, format, scans, end_ns, path_m, "
      "payload) VALUES ('hall', 'r1', 7, repeat('a', 64), 2, 1, 1, 1, $1)",
      {std::span<const std::byte>(coded->bytes)});
  Connection ada = as("hall.ada");
  EXPECT_THAT([&] { (void)visits_to_learn(ada, "hall", {}); },
              ThrowsMessage<InputError>(testing::AllOf(HasSubstr("visit 7 of r1"),
                                                       HasSubstr("relative to version bbbbbbbb"),
                                                       HasSubstr("strata fleet release"))));
  EXPECT_EQ(visit_names(ada, "hall").size(), 1U);
}

}  // namespace
}  // namespace strata::fleet
