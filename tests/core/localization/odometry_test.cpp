// SPDX-License-Identifier: Apache-2.0
// What the localizer makes of odometry that is late, damaged, impossible or not there.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "tests/core/localization/box_map.hpp"

namespace strata::localization {
namespace {

using test::Drive;
using test::room;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr Pose2 kStart{4.0, 2.0, 0.0};

/// Whose scans say nothing of where the robot is: what moves is odometry's.
class FlatModel final : public SensorModel {
 public:
  std::size_t log_likelihoods(const Scan& /*scan*/, const Weighing& /*weighing*/,
                              ParticleSet& /*particles*/, std::span<double> log_likelihood,
                              WorkerPool& /*pool*/) const override {
    std::fill(log_likelihood.begin(), log_likelihood.end(), -1.0);
    return 1;
  }
  [[nodiscard]] double tempering() const override { return 1.0; }
  [[nodiscard]] InlierShares inlier_shares(const Scan& /*scan*/, const Pose2& /*map_from_robot*/,
                                           const ParticleSet& /*particles*/) const override {
    return {0.9, 1.0};
  }
};

LocalizerConfig every_scan() {
  LocalizerConfig config;
  config.adaptive = false;
  config.gating.every_scans = 1;
  return config;
}

Localizer flat() {
  Localizer localizer(every_scan(), std::make_shared<FlatModel>(), 1);
  localizer.initialize({kStart, Eigen::Vector3d(1e-6, 1e-6, 1e-6).asDiagonal()});
  return localizer;
}

Observation seen(double at_s, const Pose2& odom, bool is_usable = true) {
  Observation observation;
  observation.scan.stamp = Stamp::from_seconds(at_s);
  observation.scan.range_max_m = 10.0F;
  observation.scan.ranges_m.assign(9, is_usable ? 2.0F : static_cast<float>(kNan));
  observation.odom_from_robot = odom;
  return observation;
}

double stddev_m(const LocalizationResult& result) {
  return std::sqrt(result.pose.covariance(0, 0) + result.pose.covariance(1, 1));
}

TEST(LocalizerOdometry, TheMotionBeforeTheFirstUsableScanCounts) {
  Localizer localizer = flat();
  localizer.update(seen(0.0, {}, false));
  localizer.update(seen(0.2, {0.3, 0.0, 0.0}, false));
  const LocalizationResult result = localizer.update(seen(0.4, {0.8, 0.0, 0.0}));
  EXPECT_TRUE(result.weighed);
  EXPECT_NEAR(result.pose.mean.x, kStart.x + 0.8, 0.05);
  EXPECT_GT(stddev_m(result), 0.05) << "with the noise of that way";
}

/// The spread and the heading after a start and one more scan.
LocalizationResult after(const Observation& next) {
  Localizer localizer = flat();
  localizer.update(seen(0.0, {}));
  return localizer.update(next);
}

TEST(LocalizerOdometry, DamagedOdometryHasTheNoiseOfNone) {
  Observation without = seen(0.2, {});
  without.has_odometry = false;
  const LocalizationResult blind = after(without);
  ASSERT_GT(stddev_m(blind), 0.1);
  for (const Pose2& damaged :
       {Pose2{kNan, 0.0, 0.0}, Pose2{0.0, kNan, 0.0}, Pose2{0.0, 0.0, kNan}}) {
    EXPECT_EQ(stddev_m(after(seen(0.2, damaged))), stddev_m(blind));
  }
}

TEST(LocalizerOdometry, ARejectedJumpHasTheNoiseOfNone) {
  const double told_m = stddev_m(after(seen(0.2, {0.1, 0.0, 0.0})));
  const LocalizationResult jumped = after(seen(0.2, {30.0, 0.0, 0.0}));
  EXPECT_GT(stddev_m(jumped), 3.0 * told_m);
  EXPECT_NEAR(jumped.pose.mean.x, kStart.x, 0.02);
}

TEST(LocalizerOdometry, ATurnThatNoRobotMakesIsRejectedAndCounted) {
  for (const double turn_rad : {3.0, -3.0}) {
    Localizer localizer = flat();
    localizer.update(seen(0.0, {}));
    const LocalizationResult result = localizer.update(seen(0.1, {0.0, 0.0, turn_rad}));
    EXPECT_EQ(localizer.odometry_jumps(), 1U);
    EXPECT_NEAR(result.pose.mean.theta, 0.0, 0.05);
    EXPECT_GT(std::sqrt(result.pose.covariance(2, 2)), 0.09);
    const Pose2 on = Pose2{0.0, 0.0, turn_rad} * Pose2{0.1, 0.0, 0.0};
    EXPECT_NEAR(localizer.update(seen(0.2, on)).pose.mean.x, kStart.x + 0.1, 0.05);
    EXPECT_EQ(localizer.odometry_jumps(), 1U);
  }
}

/// Drives 60 scans of 6 cm; odometry is there for a scan n where is_there(n). Returns the greatest
/// error.
double worst_error_m(const std::function<bool(int)>& is_there) {
  Drive drive({1.5, 2.2, 0.0}, 5);
  const ReflectionGrid map = test::rasterize(room(), 0.05, test::kRect);
  Localizer localizer(every_scan(), make_grid_beam_model(map), 3);
  localizer.initialize({drive.truth(), Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal()});
  double worst_m = 0.0;
  for (int n = 0; n < 60; ++n) {
    drive.step({0.06, 0.0, 0.0});
    Observation observation = drive.look(room());
    observation.has_odometry = is_there(n);
    const LocalizationResult result = localizer.update(observation);
    worst_m = std::max(worst_m, translation_distance(result.pose.mean, drive.truth()));
  }
  EXPECT_EQ(localizer.odometry_jumps(), 0U);
  return worst_m;
}

TEST(LocalizerOdometry, AWayThatWasFollowedByScansIsNotAddedAgain) {
  EXPECT_LT(worst_error_m([](int n) { return n < 20 || n >= 40; }), 0.25);
}

TEST(LocalizerOdometry, MayBeMissingNowAndThen) {
  EXPECT_LT(worst_error_m([](int n) { return n % 2 == 0; }), 0.15);
  EXPECT_LT(worst_error_m([](int n) { return n % 5 == 0; }), 0.15);
}

}  // namespace
}  // namespace strata::localization
