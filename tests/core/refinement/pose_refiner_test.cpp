// SPDX-License-Identifier: Apache-2.0
#include "core/refinement/pose_refiner.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "tests/core/refinement/surveyed_world.hpp"

namespace strata::refinement {
namespace {

using localization::LocalizationResult;
using test::BoxWorld;
using test::crooked_room;
using test::SurveyedWorld;

/// What a filter that is sure of a pose says.
LocalizationResult sure_of(const Pose2& pose, double stddev_m = 0.04, double stddev_rad = 0.01) {
  LocalizationResult result;
  result.pose = {pose, pose_covariance(stddev_m, stddev_rad)};
  result.score = 0.95;
  return result;
}

const SurveyedWorld& room() {
  static const SurveyedWorld world =
      test::survey(test::scans_at(crooked_room(), test::places(1.0, 2.0, 7.0, 4.0, 0.5), 11));
  return world;
}

Scan look(const BoxWorld& world, const Pose2& from, RandomStream& random) {
  return test::make_scan(world, from, 12.0, 360, 0.01, random, 1.0);
}

struct Errors {
  double filter_m = 0.0;
  double refined_m = 0.0;
  double refined_rad = 0.0;
  double mahalanobis_squared = 0.0;
  int refined = 0;
};

/// Mean errors over poses all over the room, with a filter that is as far off as it says.
Errors errors_in_room(PoseRefiner& refiner, int count) {
  Errors mean;
  RandomStream random(5, StreamId::kTest);
  for (int i = 0; i < count; ++i) {
    const Pose2 truth{1.0 + 6.0 * random.uniform(), 1.5 + 3.0 * random.uniform(),
                      6.0 * random.uniform()};
    const Pose2 off{truth.x + 0.03 * random.normal(), truth.y + 0.03 * random.normal(),
                    truth.theta + 0.01 * random.normal()};
    const auto refined =
        refiner.refine(look(crooked_room(), truth, random), sure_of(off, 0.03, 0.01));
    if (!refined) continue;
    ++mean.refined;
    mean.filter_m += translation_distance(off, truth);
    mean.refined_m += translation_distance(refined->mean, truth);
    mean.refined_rad += std::abs(angle_difference(refined->mean.theta, truth.theta));
    mean.mahalanobis_squared += mahalanobis_squared(*refined, truth);
  }
  for (double* value :
       {&mean.filter_m, &mean.refined_m, &mean.refined_rad, &mean.mahalanobis_squared}) {
    *value /= std::max(1, mean.refined);
  }
  return mean;
}

TEST(PoseRefiner, IsMillimetresOffWhereTheFilterIsCentimetresOff) {
  PoseRefiner refiner(room().map, room().surfaces, nullptr);
  const Errors mean = errors_in_room(refiner, 200);
  EXPECT_GE(mean.refined, 190);
  EXPECT_GT(mean.filter_m, 0.03);
  EXPECT_LT(mean.refined_m, 0.004);
  EXPECT_LT(mean.refined_rad, 0.001);
}

TEST(PoseRefiner, SaysHowFarOffItIs) {
  PoseRefiner refiner(room().map, room().surfaces, nullptr);
  // 3 where it says it right. It allows for errors of the map of 5 mm, which this one has not.
  const double mean = errors_in_room(refiner, 200).mahalanobis_squared;
  EXPECT_GT(mean, 0.02);
  EXPECT_LT(mean, 3.0);
}

TEST(PoseRefiner, IsAsGoodAsTheCellsAllowWithoutALayer) {
  PoseRefiner refiner(room().map, {}, nullptr);
  const Errors mean = errors_in_room(refiner, 200);
  EXPECT_LT(mean.refined_m, 0.025);
  EXPECT_LT(mean.refined_m, 0.7 * mean.filter_m);
  EXPECT_LT(mean.mahalanobis_squared, 4.0) << "it knows that it does not know better";
}

TEST(PoseRefiner, KeepsSilentWhereTheFilterIsNotSure) {
  PoseRefiner refiner(room().map, room().surfaces, nullptr);
  RandomStream random(7, StreamId::kTest);
  const Pose2 truth{4.0, 3.0, 0.5};
  const Scan scan = look(crooked_room(), truth, random);
  ASSERT_TRUE(refiner.refine(scan, sure_of(truth)));
  LocalizationResult result = sure_of(truth);
  result.score = 0.3;
  EXPECT_FALSE(refiner.refine(scan, result));
  result = sure_of(truth);
  result.is_ambiguous = true;
  EXPECT_FALSE(refiner.refine(scan, result));
  result = sure_of(truth);
  result.health.is_in_doubt = true;
  EXPECT_FALSE(refiner.refine(scan, result));
}

TEST(PoseRefiner, KeepsSilentWhereTheScanIsOfAnotherPlace) {
  PoseRefiner refiner(room().map, room().surfaces, nullptr);
  RandomStream random(8, StreamId::kTest);
  for (const Pose2& believed : {Pose2{4.0, 3.0, 0.0}, Pose2{2.0, 4.0, 1.0}, Pose2{6.5, 2.2, 2.0}}) {
    const Scan scan = look(crooked_room(), {believed.x + 0.7, believed.y - 0.6, 0.4}, random);
    EXPECT_FALSE(refiner.refine(scan, sure_of(believed))) << believed.x;
  }
}

/// Of every other beam what is seen from `even`, of the others what is seen from `odd`.
Scan mixed(const Pose2& even, const Pose2& odd) {
  RandomStream random(18, StreamId::kTest);
  Scan scan = look(crooked_room(), even, random);
  const Scan other = look(crooked_room(), odd, random);
  for (std::size_t i = 1; i < scan.size(); i += 2) scan.ranges_m[i] = other.ranges_m[i];
  return scan;
}

TEST(PoseRefiner, KeepsSilentWhereOneHalfOfTheHitsSpeaksAgainstTheOther) {
  PoseRefiner refiner(room().map, room().surfaces, nullptr);
  const Pose2 truth{4.0, 3.0, 0.0};
  const LocalizationResult result = sure_of(truth, 0.1, 0.02);
  EXPECT_TRUE(refiner.refine(mixed(truth, truth), result));
  EXPECT_FALSE(refiner.refine(mixed({4.09, 3.07, 0.0}, truth), result));
}

TEST(PoseRefiner, CountsHowFarBothHalvesAreApart) {
  PoseRefiner refiner(room().map, room().surfaces, nullptr, {.map_stddev_m = 0.0});
  const LocalizationResult result = sure_of({4.0, 3.0, 0.0});
  const auto one = refiner.refine(mixed(result.pose.mean, result.pose.mean), result);
  const auto two = refiner.refine(mixed({4.005, 3.0, 0.0}, {3.995, 3.0, 0.0}), result);
  ASSERT_TRUE(one && two);
  EXPECT_NEAR(two->covariance(0, 0) - one->covariance(0, 0), 0.005 * 0.005, 0.6 * 0.005 * 0.005);
}

TEST(PoseRefiner, MovesNoPoseFartherThanItIsAllowedTo) {
  RandomStream random(19, StreamId::kTest);
  const Pose2 truth{4.0, 3.0, 0.0};
  const Scan scan = look(crooked_room(), truth, random);
  const LocalizationResult off = sure_of({4.12, 3.12, 0.0}, 0.3, 0.05);
  PoseRefiner bold(room().map, room().surfaces, nullptr, {.max_shift_m = 1.0});
  const auto refined = bold.refine(scan, off);
  ASSERT_TRUE(refined);
  EXPECT_LT(translation_distance(refined->mean, truth), 0.01);
  PoseRefiner usual(room().map, room().surfaces, nullptr);
  EXPECT_FALSE(usual.refine(scan, off));
}

TEST(PoseRefiner, AsksForFortyHits) {
  PoseRefiner refiner(room().map, room().surfaces, nullptr);
  RandomStream random(20, StreamId::kTest);
  const Pose2 truth{4.0, 3.0, 0.0};
  EXPECT_TRUE(refiner.refine(test::make_scan(crooked_room(), truth, 12.0, 48, 0.01, random, 1.0),
                             sure_of(truth)));
  EXPECT_FALSE(refiner.refine(test::make_scan(crooked_room(), truth, 12.0, 36, 0.01, random, 1.0),
                              sure_of(truth)));
}

TEST(PoseRefiner, IsLessSureWithoutALayer) {
  PoseRefiner with(room().map, room().surfaces, nullptr);
  PoseRefiner without(room().map, {}, nullptr);
  const LocalizationResult result = sure_of({4.0, 3.0, 0.0});
  const Scan scan = mixed(result.pose.mean, result.pose.mean);
  const auto fine = with.refine(scan, result);
  const auto coarse = without.refine(scan, result);
  ASSERT_TRUE(fine && coarse);
  EXPECT_GT(coarse->covariance(0, 0), fine->covariance(0, 0) + 0.9 * 0.05 * 0.05 / 12.0);
}

TEST(PoseRefiner, SkipsScansThatSayNothing) {
  PoseRefiner refiner(room().map, room().surfaces, nullptr);
  Scan scan;
  EXPECT_FALSE(refiner.refine(scan, sure_of({4.0, 3.0, 0.0})));
  RandomStream random(9, StreamId::kTest);
  scan = look(crooked_room(), {4.0, 3.0, 0.0}, random);
  for (float& range : scan.ranges_m) range = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(refiner.refine(scan, sure_of({4.0, 3.0, 0.0})));
}

TEST(PoseRefiner, LeavesADirectionThatTheWallsLeaveOpenAsTheFilterHasIt) {
  const BoxWorld corridor{{-20.0, -0.3, 20.0, 0.013}, {-20.0, 2.037, 20.0, 2.4}};
  const SurveyedWorld world =
      test::survey(test::scans_at(corridor, test::places(-5.0, 1.0, 5.0, 1.0, 0.25), 12));
  PoseRefiner refiner(world.map, world.surfaces, nullptr);
  RandomStream random(13, StreamId::kTest);
  const Pose2 believed{0.04, 1.03, 0.0};
  const auto refined = refiner.refine(look(corridor, {0.0, 1.0, 0.0}, random), sure_of(believed));
  ASSERT_TRUE(refined);
  EXPECT_NEAR(refined->mean.y, 1.0, 0.004);
  EXPECT_NEAR(refined->mean.x, believed.x, 0.02);
  EXPECT_GT(std::sqrt(refined->covariance(0, 0)), 0.02);
  EXPECT_LT(std::sqrt(refined->covariance(1, 1)), 0.01);
}

/// A corridor whose one mark is a cupboard that comes and goes.
struct Cupboard {
  BoxWorld empty{{-20.0, -0.3, 20.0, 0.013}, {-20.0, 2.037, 20.0, 2.4}};
  BoxWorld full = with_cupboard();
  patch::PatchMap patches;
  SurveyedWorld world;

  Cupboard() {
    auto scans = test::scans_at(empty, test::places(-4.0, 1.0, 4.0, 1.0, 0.25), 14);
    const auto more = test::scans_at(full, test::places(-4.0, 1.2, 4.0, 1.2, 0.25), 15);
    const ReflectionGrid without = test::survey(scans).map;
    const ReflectionGrid with = test::survey(more).map;
    scans.insert(scans.end(), more.begin(), more.end());
    world = test::survey(scans);
    patches.base = world.map;
    patch::Submap submap;
    submap.rect = {{10, 1}, {40, 20}};
    for (const ReflectionGrid* grid : {&without, &with}) {
      patch::Configuration configuration;
      configuration.reflection = grid->cropped(submap.rect);
      configuration.prior = 0.5;
      submap.configurations.push_back(configuration);
    }
    patches.submaps.push_back(submap);
  }
  [[nodiscard]] BoxWorld with_cupboard() const {
    BoxWorld boxes = empty;
    boxes.push_back({0.821, 0.0, 1.613, 0.617});
    return boxes;
  }
};

TEST(PoseRefiner, RegistersWithWhatIsBelievedToBeThereOfAChangeableArea) {
  const Cupboard cupboard;
  PoseRefiner refiner(cupboard.world.map, cupboard.world.surfaces, &cupboard.patches);
  RandomStream random(16, StreamId::kTest);
  const Scan scan = look(cupboard.full, {0.0, 1.0, 0.0}, random);
  LocalizationResult result = sure_of({0.04, 1.0, 0.0});
  result.submaps = {{0, 1.0, {0.01, 0.99}}};
  const auto known = refiner.refine(scan, result);
  ASSERT_TRUE(known);
  EXPECT_NEAR(known->mean.x, 0.0, 0.008) << "the cupboard tells";
  result.submaps = {{0, 1.0, {0.5, 0.5}}};
  const auto unknown = refiner.refine(scan, result);
  ASSERT_TRUE(unknown);
  EXPECT_NEAR(unknown->mean.x, 0.04, 0.015) << "nobody knows whether it is there";
  EXPECT_GT(unknown->covariance(0, 0), 2.0 * known->covariance(0, 0));
}

TEST(PoseRefiner, GivesTheSameBitsWhateverCameBefore) {
  const Cupboard cupboard;
  RandomStream random(17, StreamId::kTest);
  const Scan scan = look(cupboard.full, {0.0, 1.0, 0.0}, random);
  LocalizationResult result = sure_of({0.03, 1.01, 0.0});
  result.submaps = {{0, 1.0, {0.02, 0.98}}};
  PoseRefiner first(cupboard.world.map, cupboard.world.surfaces, &cupboard.patches);
  const auto once = first.refine(scan, result);
  ASSERT_TRUE(once);
  LocalizationResult other = result;
  other.submaps[0].probability = {0.98, 0.02};
  (void)first.refine(scan, other);
  const auto again = first.refine(scan, result);
  ASSERT_TRUE(again);
  EXPECT_EQ(once->mean.x, again->mean.x);
  EXPECT_EQ(once->mean.y, again->mean.y);
  EXPECT_EQ(once->mean.theta, again->mean.theta);
  EXPECT_EQ(once->covariance, again->covariance);
}

TEST(PoseRefiner, RefusesSettingsThatMakeNoSense) {
  RefinementConfig config;
  config.hit_stddev_m = 0.0;
  EXPECT_THROW(PoseRefiner(room().map, room().surfaces, nullptr, config), ConfigError);
}

}  // namespace
}  // namespace strata::refinement
