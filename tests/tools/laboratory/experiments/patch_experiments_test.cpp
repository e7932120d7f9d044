// SPDX-License-Identifier: Apache-2.0
// The papers' experiments, each on one seed that no result in docs uses.
#include <string>

#include <gtest/gtest.h>

#include "core/scan/endpoints.hpp"
#include "tools/laboratory/experiments/open_gates.hpp"
#include "tools/laboratory/experiments/patch_learning.hpp"
#include "tools/laboratory/experiments/patch_localization.hpp"
#include "tools/laboratory/experiments/standing_robot.hpp"
#include "tools/simulate/random_office.hpp"

namespace strata::experiments {
namespace {

constexpr std::uint64_t kSeed = 102;

std::string scenario(const char* name) { return std::string(STRATA_SCENARIO_DIR) + "/" + name; }

TEST(ThreeDoors, AllConfigurationsAreFoundAndNoneExtra) {
  const Judgement j = three_doors(scenario("three_doors.yaml"), kSeed, kGoodPoses);
  EXPECT_EQ(j.changed_objects, 3);
  EXPECT_EQ(j.found_objects, 3);
  EXPECT_EQ(j.submaps, 3);
  EXPECT_EQ(j.right_submaps, 3);
  EXPECT_EQ(j.right_sequences, j.sequences);
}

TEST(LocalMaps, SeventeenPassesGiveFourConfigurations) {
  const Judgement j = local_maps(scenario("four_states.yaml"), kSeed, kGoodPoses);
  EXPECT_EQ(j.submaps, 1);
  EXPECT_EQ(j.right_submaps, 1);
  EXPECT_EQ(j.missing_configurations, 0);
}

TEST(FewVisits, TwoDaysFindWhatChangedAndNothingElse) {
  const Judgement j = office_visits(kSeed, 2, true, kGoodPoses);
  EXPECT_GE(j.changed_objects, 3);
  EXPECT_GE(j.found_objects, j.changed_objects - 1);
  EXPECT_EQ(j.false_submaps, 0);
}

TEST(StaticOffice, HasNoSubmaps) {
  EXPECT_EQ(office_visits(kSeed, 3, false, kGoodPoses).submaps, 0);
}

TEST(Gates, OntoNothingAreFoundOpenAndClosed) {
  const Judgement j = learn_hall(hall_with_gate(kSeed), kSeed, kGoodPoses);
  EXPECT_EQ(j.changed_objects, 1);
  EXPECT_EQ(j.found_objects, 1);
  EXPECT_EQ(j.right_submaps, 1);
  EXPECT_EQ(j.false_submaps, 0);
  EXPECT_EQ(j.right_sequences, j.sequences);
}

TEST(Glass, IsNoAreaThatChanges) {
  EXPECT_EQ(learn_hall(hall_with_glass(kSeed), kSeed, kGoodPoses).submaps, 0);
}

TEST(StandingRobot, FindsTheDoorThatMovesInView) {
  for (const Judgement& j :
       {standing_robot(kSeed, 4, kGoodPoses), standing_robot_online(kSeed, 4, kGoodPoses)}) {
    EXPECT_EQ(j.changed_objects, 1);
    EXPECT_EQ(j.found_objects, 1);
    EXPECT_EQ(j.right_submaps, j.submaps);
  }
}

TEST(StandingRobot, LearnsNothingFromPeopleWhoLinger) {
  EXPECT_EQ(standing_robot(kSeed, 0, kGoodPoses).submaps, 0);
  EXPECT_EQ(standing_robot_online(kSeed, 0, kGoodPoses).submaps, 0);
}

TEST(RandomOffice, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const simulate::ScenarioConfig a = simulate::random_office(7, {});
  const simulate::ScenarioConfig b = simulate::random_office(7, {});
  const simulate::ScenarioConfig c = simulate::random_office(8, {});
  EXPECT_EQ(a.robot.route, b.robot.route);
  EXPECT_EQ(a.doors.size(), b.doors.size());
  EXPECT_NE(a.robot.route, c.robot.route);
  EXPECT_GE(a.doors.size(), 3U);
}

/// Means over seeds.
struct BoxErrors {
  double patch_m = 0.0;
  double filtered_m = 0.0;
  double own_day_m = 0.0;
  int entries = 0;
  int recognized = 0;
};

BoxErrors box_errors(int field_of_view_deg) {
  constexpr int kSeeds = 4;
  BoxErrors errors;
  for (std::uint64_t seed = kSeed; seed < kSeed + kSeeds; ++seed) {
    const Outcomes outcomes = box_in_corridor(scenario("corridor_box.yaml"), seed,
                                              field_of_view_deg, {"patch", "filtered", "own_day"});
    errors.patch_m += outcomes.at("patch").changed_error_m / kSeeds;
    errors.filtered_m += outcomes.at("filtered").changed_error_m / kSeeds;
    errors.own_day_m += outcomes.at("own_day").changed_error_m / kSeeds;
    errors.entries += outcomes.at("patch").entries;
    errors.recognized += outcomes.at("patch").recognized;
  }
  return errors;
}

TEST(BoxInCorridor, WithAScannerAllRoundPatchHasAThirdOfTheFilteredMapsError) {
  const BoxErrors errors = box_errors(360);
  EXPECT_LT(errors.patch_m, 0.15);
  EXPECT_LT(errors.patch_m, errors.filtered_m / 3.0);
  EXPECT_EQ(errors.entries, 8);
  EXPECT_EQ(errors.recognized, 8);
}

TEST(BoxInCorridor, WithAScannerAheadNoMapIsMuchBetterThanPatchNotEvenOneOfTheDayItself) {
  const BoxErrors errors = box_errors(180);
  EXPECT_LT(errors.patch_m, 0.15);
  EXPECT_LT(errors.patch_m, 0.6 * errors.filtered_m);
  EXPECT_LT(errors.patch_m, 1.25 * errors.own_day_m);
  EXPECT_EQ(errors.entries, 8);
  EXPECT_EQ(errors.recognized, 8);
}

TEST(PatchExperiments, TheDoorOpensInTheMiddleOfTheDrive) {
  const auto drive =
      drive_while_door_opens(std::string(STRATA_SCENARIO_DIR) + "/side_door.yaml", 1);
  // Beams that end beyond the door, whose wall is the line y = 0.
  const auto through = [&](std::size_t begin, std::size_t end) {
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const auto& scan = drive.days[0].scans[i];
      const Endpoints ends = endpoints_in_robot(scan.observation.scan);
      for (std::size_t n = 0; n < ends.size(); ++n) {
        const Eigen::Vector2d point =
            scan.map_from_robot * Eigen::Vector2d(ends.x_m[n], ends.y_m[n]);
        const bool is_beyond = point.x() > 11.6 && point.x() < 12.4 && point.y() < -0.3;
        count += is_beyond ? 1 : 0;
      }
    }
    return count;
  };
  const std::size_t scans = drive.days[0].scans.size();
  EXPECT_EQ(through(0, scans / 2 - 5), 0U);
  EXPECT_GT(through(scans / 2 + 5, scans), 20U);  // the room's far wall is at the laser's reach
}

TEST(PatchExperiments, PatchesFollowADoorThatOpensAfterAGlobalStart) {
  const auto phases =
      door_opens(std::string(STRATA_SCENARIO_DIR) + "/side_door.yaml", 1, {"patch", "open"});
  EXPECT_LT(phases.at("patch").closed_m, 0.5);
  EXPECT_LT(phases.at("patch").open_m, 0.5);
  EXPECT_GT(phases.at("open").closed_m, 1.0);  // it takes the look-alike for its place
}

}  // namespace
}  // namespace strata::experiments
