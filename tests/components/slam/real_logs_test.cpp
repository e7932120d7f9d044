// SPDX-License-Identifier: Apache-2.0
// SLAM on recorded logs against the hand-verified relations [kummerle2009measuring].
#include <cmath>
#include <cstddef>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "components/log/log_reader.hpp"
#include "core/slam/slam.hpp"
#include "tests/support/test_data.hpp"

namespace strata::slam {
namespace {

/// Microseconds, as the relations name scans.
std::int64_t key_of(double stamp_s) { return std::llround(stamp_s * 1e6); }

TEST(SlamOnRealLogs, AgreesWithTheRelationsOfFreiburg079) {
  STRATA_REQUIRE_DATA(log_path, "fr079/fr079.clf.gz");
  STRATA_REQUIRE_DATA(relations_path, "fr079/fr079.relations");
  log::ReadOptions options;
  options.to_s = 200.0;
  Slam slam(SlamConfig{}, 2);
  for (const Observation& observation : log::read_observations(log_path, options)) {
    slam.add(observation);
  }
  const SlamResult result = slam.finish();
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
  ASSERT_GT(count, 100U);
  EXPECT_LT(sum_m / static_cast<double>(count), 0.06);
}

}  // namespace
}  // namespace strata::slam
