// SPDX-License-Identifier: Apache-2.0
/// Stores that were kept in the frame of another map.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/components/volume_mapper/robot.hpp"
#include "tests/support/test_data.hpp"

namespace strata::volume_mapper {
namespace {

constexpr double kHall_m = 12.0;
constexpr double kDrive_m = 1.5;

/// Walls across a hall, every 3 m along it and beside the robot's way, and the floor: as a scanner
/// at x sees them that turns like the hall.
std::vector<Eigen::Vector3f> hall_from(double x) {
  std::vector<Eigen::Vector3f> points;
  const auto add = [&](double at_x, double y, double z) {
    points.emplace_back(static_cast<float>(at_x - x), static_cast<float>(y), static_cast<float>(z));
  };
  for (double wall_x = 0.05; wall_x <= kHall_m + 0.1; wall_x += 3.0) {
    if (std::abs(wall_x - x) > 6.0) continue;
    for (double y = 1.05; y < 4.0; y += 0.1) {
      for (double z = -0.45; z < 0.5; z += 0.1) add(wall_x, y, z);
    }
  }
  for (double floor_x = x - 4.0; floor_x < x + 4.0; floor_x += 0.1) {
    for (double y = -1.0; y < 4.0; y += 0.1) add(floor_x, y, -0.55);
  }
  return points;
}

/// Through the hall, whose beginning lies at `origin_x` in the map.
void drive(Robot& robot, double origin_x) {
  robot.move(0.0, origin_x - 0.25);
  int step = 0;
  for (double x = 0.0; x <= kHall_m; x += kDrive_m, ++step) {
    robot.move(step + 1.0, origin_x + x - 0.25);
    robot.see(step + 1.0, hall_from(x));
  }
  robot.move(step + 1.0, origin_x);
}

class VolumeMapperInAFrame : public testing::Test {
 protected:
  static constexpr const char* kClouds = "9";
  [[nodiscard]] std::filesystem::path store() const { return folder_.path() / "map.ot"; }
  [[nodiscard]] std::filesystem::path aside() const { return store().string() + ".damaged"; }
  [[nodiscard]] std::string parameters() const {
    return "publish_period_s: 0, store_period_s: 0, waiting_clouds: 100, store: '" +
           store().string() + "'";
  }
  /// What its status says at the end.
  test::DiagnosticStatus drive_with_a_store(double origin_x) const {
    Robot robot(parameters());
    drive(robot, origin_x);
    return robot.status("clouds", kClouds);
  }

 private:
  test::TemporaryDirectory folder_;
};

TEST_F(VolumeMapperInAFrame, SetsAsideWhatWasMappedInAnother) {
  drive_with_a_store(0.0);
  ASSERT_TRUE(std::filesystem::exists(store()));
  const std::string before = test::bytes_of(store());
  const auto status = drive_with_a_store(-1.5);
  EXPECT_THAT(status.message(), testing::HasSubstr("set aside as '" + aside().string() + "'"));
  ASSERT_TRUE(std::filesystem::exists(aside()));
  EXPECT_EQ(test::bytes_of(aside()), before);
  // What comes from then on is kept in the new frame.
  EXPECT_TRUE(std::filesystem::exists(store()));
  drive_with_a_store(-1.5);
  EXPECT_FALSE(std::filesystem::exists(aside().string() + "-2"));
}

TEST_F(VolumeMapperInAFrame, GoesOnInItsOwn) {
  drive_with_a_store(0.0);
  EXPECT_EQ(drive_with_a_store(0.0).message(), "OK");
  EXPECT_FALSE(std::filesystem::exists(aside()));
}

}  // namespace
}  // namespace strata::volume_mapper
