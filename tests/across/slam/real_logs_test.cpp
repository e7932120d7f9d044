// SPDX-License-Identifier: Apache-2.0
// SLAM on recorded logs against the hand-verified relations [kummerle2009measuring].
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "components/log/log_reader.hpp"
#include "core/slam/slam.hpp"
#include "tests/support/test_data.hpp"

namespace strata::slam {
namespace {

/// Microseconds, as the relations name scans.
std::int64_t key_of(double stamp_s) { return std::llround(stamp_s * 1e6); }

log::ReadOptions first_seconds(double to_s) {
  log::ReadOptions options;
  options.to_s = to_s;
  return options;
}

/// Mean distance from the relations of a log [m], and whether the map is
/// held to be consistent.
double relation_error(const std::string& log_path, const std::string& relations_path,
                      const log::ReadOptions& options, bool odometry, bool* consistent = nullptr) {
  Slam slam(SlamConfig{}, 2);
  for (Observation observation : log::read_observations(log_path, options)) {
    observation.has_odometry = observation.has_odometry && odometry;
    slam.add(observation);
  }
  const SlamResult result = slam.finish();
  if (consistent != nullptr) *consistent = result.consistency.consistent;
  std::map<std::int64_t, Pose2> poses;
  for (const PosedScan& scan : result.scans) {
    poses[key_of(scan.scan.stamp.seconds())] = scan.map_from_robot;
  }
  std::ifstream relations(relations_path);
  std::string line;
  double sum_m = 0.0;
  std::size_t count = 0;
  while (std::getline(relations, line)) {
    std::istringstream fields(line);
    double t1, t2, x, y, z, roll, pitch, yaw;
    if (!(fields >> t1 >> t2 >> x >> y >> z >> roll >> pitch >> yaw)) continue;
    const auto a = poses.find(key_of(t1));
    const auto b = poses.find(key_of(t2));
    if (a == poses.end() || b == poses.end()) continue;
    const Pose2 error = between(Pose2{x, y, yaw}, between(a->second, b->second));
    sum_m += std::hypot(error.x, error.y);
    ++count;
  }
  EXPECT_GT(count, 100U);
  return sum_m / static_cast<double>(count);
}

TEST(SlamOnRealLogs, AgreesWithTheRelationsOfFreiburg079) {
  STRATA_REQUIRE_DATA(log_path, "fr079/fr079.clf.gz");
  STRATA_REQUIRE_DATA(relations_path, "fr079/fr079.relations");
  EXPECT_LT(relation_error(log_path, relations_path, first_seconds(200.0), true), 0.06);
}

TEST(SlamOnRealLogs, AgreesWithTheRelationsOfIntelWithoutOdometry) {
  STRATA_REQUIRE_DATA(log_path, "intel/intel.clf.gz");
  STRATA_REQUIRE_DATA(relations_path, "intel/intel.relations");
  // Stamps of delivery, by a clock that was set back now and then.
  EXPECT_LT(relation_error(log_path, relations_path, first_seconds(280.0), false), 0.03);
}

// Its odometry is stamped 0.17 s early; that is found and taken out.
TEST(SlamOnRealLogs, AgreesWithTheRelationsOfCsailAndContradictsItselfNowhere) {
  STRATA_REQUIRE_DATA(log_path, "csail/csail.clf.gz");
  STRATA_REQUIRE_DATA(relations_path, "csail/csail.relations");
  bool consistent = false;
  EXPECT_LT(relation_error(log_path, relations_path, {}, true, &consistent), 0.07);
  EXPECT_TRUE(consistent);
}

// Its odometry is 0.17 s early.
TEST(SlamOnRealLogs, MakesOneMapOfCsailWithItsStampsAsTheyAre) {
  STRATA_REQUIRE_DATA(log_path, "csail/csail.clf.gz");
  STRATA_REQUIRE_DATA(relations_path, "csail/csail.relations");
  log::ReadOptions as_stamped;
  as_stamped.odometry_lag_s = 0.0;
  bool consistent = false;
  EXPECT_LT(relation_error(log_path, relations_path, as_stamped, true, &consistent), 0.1);
  EXPECT_TRUE(consistent);
}

TEST(SlamOnRealLogs, HoldsCsailToBeFoldedAtThePosesOfItsOdometry) {
  STRATA_REQUIRE_DATA(log_path, "csail/csail.clf.gz");
  std::vector<PosedScan> scans;
  for (Observation& observation : log::read_observations(log_path, {})) {
    PosedScan& posed = scans.emplace_back();
    posed.map_from_robot = observation.odom_from_robot;
    posed.scan = std::move(observation.scan);
  }
  WorkerPool pool(2);
  const Consistency found = check_consistency(scans, pool);
  EXPECT_FALSE(found.consistent);
  EXPECT_GT(found.contradicting, found.compared / 4);
}

TEST(SlamOnRealLogs, MakesOneMapOfAMuseumFullOfVisitors) {
  STRATA_REQUIRE_DATA(log_path, "fhw/fhw-corrected.log.gz");
  // Key scans a metre apart, up to 85% of whose beams hit visitors. The odometry in the log is the
  // corrected pose: good to a few decimetres, and what is right as a whole by it is one map.
  Slam slam(SlamConfig{}, 2);
  std::vector<Pose2> corrected;
  for (const Observation& observation : log::read_observations(log_path, {})) {
    corrected.push_back(observation.odom_from_robot);
    slam.add(observation);
  }
  const SlamResult result = slam.finish();
  ASSERT_EQ(result.scans.size(), corrected.size());
  std::vector<Pose2> found;
  for (const PosedScan& scan : result.scans) found.push_back(scan.map_from_robot);
  const Pose2 corrected_from_map = align(found, corrected);
  double worst_m = 0.0;
  double sum_m = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double off_m = translation_distance(corrected_from_map * found[i], corrected[i]);
    worst_m = std::max(worst_m, off_m);
    sum_m += off_m;
  }
  EXPECT_LT(worst_m, 0.5);
  EXPECT_LT(sum_m / static_cast<double>(found.size()), 0.2);
}

}  // namespace
}  // namespace strata::slam
