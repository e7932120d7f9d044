// SPDX-License-Identifier: Apache-2.0
#include "components/beam_filter/beam_filter.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/beam_filter/register.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/components/runtime/status_watch.hpp"
#include "tests/support/test_data.hpp"

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
  [[nodiscard]] runtime::Host& host() { return *host_; }
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
template <typename Message = LaserScan>
Message answer(test::Collector<Message>& answers, Stamp stamp) {
  std::size_t count = 1;
  while (true) {
    const auto all = answers.wait_for(count);
    if (all.size() < count) return {};
    const auto found = std::find_if(all.begin(), all.end(), [&](const Message& message) {
      return convert::from_message(message.header().stamp()) == stamp;
    });
    if (found != all.end()) return *found;
    count = all.size() + 1;
  }
}

/// Sensor data is best effort: what is sent before both sides know each other is lost. Shows scans
/// until both classes come; returns how many, 200 when none did.
template <typename MakeScan>
int meet(Robot& robot, const MakeScan& make_scan) {
  for (int sent = 1; sent < 200; ++sent) {
    robot.see(make_scan(sent - 1));
    const std::chrono::milliseconds a_while(100);
    if (!robot.static_.wait_for(1, a_while).empty() &&
        !robot.dynamic_.wait_for(1, a_while).empty()) {
      return sent;
    }
  }
  return 200;
}

TEST(BeamFilterComponent, PublishesEveryBeamInOneOfTwoScans) {
  Robot robot("map_every_scans: 10");
  int sent = meet(robot, [](int t) { return at_the_wall(t, false); });
  ASSERT_LT(sent, 200);
  for (int t = 0; t < 20; ++t) {
    const bool last = t == 19;
    const PosedScan scan = at_the_wall(sent++, last);
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

constexpr std::size_t kManyBeams = 1'080;
constexpr double kHall_m = 5.0;  // half a square hall
constexpr double kPerson_m = 2.0;
constexpr int kLap = 160;  // scans until the robot is where it was

/// A drive to and fro in a hall, 40 scans of 1,080 beams a second; somebody may stand at (0, 2).
PosedScan in_the_hall(int t, bool with_person) {
  PosedScan posed;
  const double phase = 2.0 * std::numbers::pi * t / kLap;
  posed.map_from_robot = {2.0 * std::sin(phase), 0.0, 0.0};
  posed.scan.stamp = Stamp::from_seconds(1.0 + 0.025 * t);
  posed.scan.angle_min_rad = static_cast<float>(-0.75 * std::numbers::pi);
  posed.scan.angle_increment_rad = static_cast<float>(1.5 * std::numbers::pi / (kManyBeams - 1));
  posed.scan.range_max_m = 30.0F;
  const double x_m = posed.map_from_robot.x;
  for (std::size_t n = 0; n < kManyBeams; ++n) {
    const double c = std::cos(posed.scan.bearing_rad(n)) + 1e-9;
    const double s = std::sin(posed.scan.bearing_rad(n)) + 1e-9;
    double range_m =
        std::min(((c > 0.0 ? kHall_m : -kHall_m) - x_m) / c, (s > 0.0 ? kHall_m : -kHall_m) / s);
    const double beside_m = s > 0.0 ? x_m + c / s * kPerson_m : kHall_m;
    if (with_person && std::abs(beside_m) < 0.25) range_m = kPerson_m / s;
    posed.scan.ranges_m.push_back(static_cast<float>(range_m + 0.02));
  }
  return posed;
}

TEST(BeamFilterComponent, LabelsEveryScanOfALongDriveAndHoldsItsWindowAndMapAlone) {
  Robot robot("map_every_scans: 25, window: {scans: 40}");
  test::StatusWatch watch(robot.participant_);
  int sent = meet(robot, [](int t) { return in_the_hall(t, true); });
  ASSERT_LT(sent, 200);
  std::string cells;
  for (int lap = 1; lap <= 3; ++lap) {
    for (; sent < lap * kLap; ++sent) {
      const PosedScan scan = in_the_hall(sent, lap == 1);
      robot.see(scan);
      // One at a time: the answer to a scan needs no later one.
      ASSERT_EQ(answer(robot.static_, scan.scan.stamp).ranges().size(), kManyBeams);
      ASSERT_EQ(answer(robot.dynamic_, scan.scan.stamp).ranges().size(), kManyBeams);
    }
    const auto status = watch.wait_for(robot.host(), [&](const auto& now) {
      return test::value_of(now, "scans") == std::to_string(sent);
    });
    EXPECT_EQ(test::value_of(status, "scans in window"), "40");
    if (lap == 1) cells = test::value_of(status, "cells of the map");
    EXPECT_EQ(test::value_of(status, "cells of the map"), cells);
  }
  EXPECT_LT(std::stoull(cells), 120'000U);  // 10 m x 10 m of 0.05 m, with room to grow
  // Whoever stood there has left the map, as it came anew again and again.
  const auto maps = robot.maps_.wait_for(3 * kLap / 25);
  const auto occupancy_at = [](const nav_msgs::msg::OccupancyGrid& map, double x_m, double y_m) {
    const auto& info = map.info();
    const auto column = static_cast<std::uint32_t>((x_m - info.origin().position().x()) /
                                                   static_cast<double>(info.resolution()));
    const auto row = static_cast<std::uint32_t>((y_m - info.origin().position().y()) /
                                                static_cast<double>(info.resolution()));
    return map.data()[row * info.width() + column];
  };
  ASSERT_GE(maps.size(), 3U);
  EXPECT_GT(occupancy_at(maps.front(), 0.0, kPerson_m + 0.02), 50);
  EXPECT_LT(occupancy_at(maps.back(), 0.0, kPerson_m + 0.02), 25);  // no obstacle
  EXPECT_GT(occupancy_at(maps.back(), 0.0, kHall_m + 0.02), 50);
}

TEST(BeamFilterComponent, GoesOnFromItsStoreWithTheMapOfBefore) {
  const test::TemporaryDirectory folder;
  const std::string parameters =
      "map_every_scans: 1, store: {file: '" + (folder.path() / "filter.state").string() + "'}";
  nav_msgs::msg::OccupancyGrid before;
  {
    Robot robot(parameters);
    const int sent = meet(robot, [](int t) { return at_the_wall(t, false); });
    ASSERT_LT(sent, 200);
    PosedScan last;
    for (int t = sent; t < sent + 20; ++t) {
      last = at_the_wall(t, false);
      robot.see(last);
      // One at a time, so that no queue is too short.
      ASSERT_EQ(answer(robot.static_, last.scan.stamp).ranges().size(), last.scan.size());
    }
    before = answer(robot.maps_, last.scan.stamp);
    ASSERT_FALSE(before.data().empty());
  }
  Robot robot(parameters);
  const auto maps = robot.maps_.wait_for(1);
  ASSERT_FALSE(maps.empty()) << "told before any scan comes";
  EXPECT_EQ(maps.front().data(), before.data());
  // Whom it had never seen there it tells from the wall at once.
  int sent = 0;
  ASSERT_LT(meet(robot, [&](int t) { return at_the_wall(500 + (sent = t), true); }), 200);
  const LaserScan taken = answer(robot.dynamic_, at_the_wall(500 + sent, true).scan.stamp);
  ASSERT_EQ(taken.ranges().size(), 11U);
  EXPECT_FALSE(std::isnan(taken.ranges()[kPassersBy]));
}

}  // namespace
}  // namespace strata::beam_filter
