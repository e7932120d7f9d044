// SPDX-License-Identifier: Apache-2.0
#include "tests/components/log/log_fixture.hpp"

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "core/geometry/angle.hpp"

namespace strata::log::test_log {
namespace {

/// A small generator of its own: fixtures must not change with core/random.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2 + 1) {}
  double uniform() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

}  // namespace

LogContent make_log(std::size_t scans, std::size_t beams, std::uint64_t seed) {
  Random random(seed);
  LogContent content;
  for (std::size_t i = 0; i < scans; ++i) {
    const double t = 1.0 + 0.2 * static_cast<double>(i);
    const Pose2 pose{0.1 * t, 0.03 * t * t, wrap_angle(0.2 * t)};
    content.odometry.push_back({Stamp::from_seconds(t - 0.1), {pose.x - 0.01, pose.y, pose.theta}});
    Observation observation;
    observation.odom_from_robot = pose;
    Scan& scan = observation.scan;
    scan.stamp = Stamp::from_seconds(t);
    const double step = 180.0 / static_cast<double>(beams);
    scan.angle_min_rad = static_cast<float>(degrees_to_radians(-90.0 + step / 2.0));
    scan.angle_increment_rad = static_cast<float>(degrees_to_radians(step));
    scan.range_max_m = 80.0F;
    scan.robot_from_laser = {0.25, 0.0, 0.0};
    for (std::size_t beam = 0; beam < beams; ++beam) {
      const bool nothing = random.uniform() < 0.1;
      scan.ranges_m.push_back(nothing ? std::numeric_limits<float>::infinity()
                                      : static_cast<float>(0.5 + 9.0 * random.uniform()));
    }
    content.observations.push_back(observation);
  }
  return content;
}

std::vector<std::int64_t> BagContent::stamps() const {
  std::vector<std::int64_t> result;
  for (const auto& [stamp, data] : messages) result.push_back(stamp);
  return result;
}

BagContent read_bag(const std::filesystem::path& path) {
  const auto reader = BagReader::open(path);
  BagContent content;
  BagMessage message;
  while (reader->next(message)) content.messages.emplace_back(message.stamp.ns, message.data);
  content.topics = reader->topics();
  content.damage = reader->damage();
  content.description = reader->description();
  return content;
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isnan(a[i]) && std::isnan(b[i])) continue;
    if (std::memcmp(&a[i], &b[i], sizeof(float)) != 0) return false;
  }
  return true;
}

}  // namespace strata::log::test_log
