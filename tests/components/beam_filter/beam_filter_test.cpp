// SPDX-License-Identifier: Apache-2.0
#include "components/beam_filter/beam_filter.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/beam_filter/register.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "tests/components/runtime/host_fixture.hpp"

namespace strata::beam_filter {
namespace {

using sensor_msgs::msg::LaserScan;

constexpr std::size_t kPassersBy = 3;  // the beam that somebody walks into
constexpr std::size_t kNoReturn = 5;

/// Eleven beams at a wall 2.5 m ahead of a robot that stands still.
PosedScan at_the_wall(int t, bool with_passer_by) {
  PosedScan posed;
  posed.scan.stamp = Stamp::from_seconds(1.0 + 0.025 * t);
  posed.scan.angle_min_rad = -0.5F;
  posed.scan.angle_increment_rad = 0.1F;
  posed.scan.range_max_m = 10.0F;
  for (std::size_t n = 0; n < 11; ++n) {
    posed.scan.ranges_m.push_back(static_cast<float>(2.52 / std::cos(posed.scan.bearing_rad(n))));
  }
  posed.scan.ranges_m[kNoReturn] = std::numeric_limits<float>::infinity();
  if (with_passer_by) posed.scan.ranges_m[kPassersBy] = 1.3F;
  return posed;
}

/// The component, what it hears and what it answers.
class Robot {
 public:
  explicit Robot(const std::string& parameters)
      : participant_(test::make_participant()),
        static_(participant_, "/scan_static", "sensor_data"),
        dynamic_(participant_, "/scan_dynamic", "sensor_data"),
        maps_(participant_, "/map_filtered", "latched"),
        scans_(participant_, "/posed_scan", bus::qos_profile("lossless")) {
    register_component(registry_);
    host_ = test::make_host(
        "{type: strata::BeamFilter, name: filter, parameters: {" + parameters + "}}", registry_,
        test::make_participant());
    host_->activate();
    EXPECT_TRUE(scans_.raw().wait_for_readers(1, std::chrono::seconds(20)));
  }
  void see(const PosedScan& scan) { scans_.publish(convert::to_message(scan, "map", "laser")); }

  std::shared_ptr<bus::Participant> participant_;
  test::Collector<LaserScan> static_;
  test::Collector<LaserScan> dynamic_;
  test::Collector<nav_msgs::msg::OccupancyGrid> maps_;

 private:
  bus::Writer<strata_msgs::msg::LabeledScan> scans_;
  runtime::Registry registry_;
  std::unique_ptr<runtime::Host> host_;
};

/// The answer to the scan of that stamp; an empty one when none comes.
LaserScan answer(test::Collector<LaserScan>& answers, Stamp stamp) {
  std::size_t count = 1;
  while (true) {
    const auto all = answers.wait_for(count);
    if (all.size() < count) return {};
    const auto found = std::find_if(all.begin(), all.end(), [&](const LaserScan& scan) {
      return convert::from_message(scan.header().stamp()) == stamp;
    });
    if (found != all.end()) return *found;
    count = all.size() + 1;
  }
}

TEST(BeamFilterComponent, PublishesEveryBeamInOneOfTwoScans) {
  Robot robot("map_every_scans: 10");
  // Sensor data is best effort: what is sent before both sides know each other is lost.
  std::size_t sent = 0;
  std::size_t heard = 0;
  while (sent < 200 && heard == 0) {
    robot.see(at_the_wall(static_cast<int>(sent++), false));
    const std::chrono::milliseconds a_while(100);
    heard = std::min(robot.static_.wait_for(1, a_while).size(),
                     robot.dynamic_.wait_for(1, a_while).size());
  }
  ASSERT_GT(heard, 0U);
  for (int t = 0; t < 20; ++t) {
    const bool last = t == 19;
    const PosedScan scan = at_the_wall(static_cast<int>(sent++), last);
    robot.see(scan);
    // One at a time, so that no queue is too short.
    const LaserScan kept = answer(robot.static_, scan.scan.stamp);
    const LaserScan taken = answer(robot.dynamic_, scan.scan.stamp);
    ASSERT_EQ(kept.ranges().size(), scan.scan.size());
    ASSERT_EQ(taken.ranges().size(), scan.scan.size());
    for (std::size_t n = 0; n < scan.scan.size(); ++n) {
      const bool dynamic = last && n == kPassersBy;
      const float in = dynamic ? taken.ranges()[n] : kept.ranges()[n];
      const float out = dynamic ? kept.ranges()[n] : taken.ranges()[n];
      EXPECT_EQ(in, scan.scan.ranges_m[n]);
      EXPECT_TRUE(n == kNoReturn ? std::isinf(out) : std::isnan(out));
    }
  }
  EXPECT_GE(robot.maps_.wait_for(2).size(), 2U);
}

}  // namespace
}  // namespace strata::beam_filter
