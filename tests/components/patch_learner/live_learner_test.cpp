// SPDX-License-Identifier: Apache-2.0
/// The patch learner beside a scan matcher that is still mapping: its map comes late and grows, and
/// loop closures move scans.
#include <chrono>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "components/convert/patch_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/patch_learner/register.hpp"
#include "core/grid/counting_map.hpp"
#include "core/random/stream.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/components/runtime/status_watch.hpp"
#include "tests/core/patch/box_world.hpp"
#include "tests/core/patch/gate_world.hpp"
#include "tests/core/patch/toy_world.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/test_data.hpp"

namespace strata::patch_learner {
namespace {

/// Drives past a door that is closed and open in turn.
std::vector<PosedScan> drives(std::size_t visits) {
  std::vector<PosedScan> scans;
  for (std::size_t v = 0; v < visits; ++v) {
    RandomStream random(21, StreamId::kTest, v);
    patch::test_world::ToyRobot{}.drive(patch::test_world::corridor_with_door(v % 2 == 0),
                                        {1.0, 1.2, 0.0}, {10.0, 1.2, 0.0}, 0,
                                        100.0 * static_cast<double>(v), {}, random, scans);
  }
  return scans;
}

/// As before a loop was closed: further off with each drive.
PosedScan drifted(PosedScan scan) {
  const double drives = std::floor(scan.scan.stamp.seconds() / 100.0);
  scan.map_from_robot = Pose2{0.07 * drives, 0.11 * drives, 0.0} * scan.map_from_robot;
  return scan;
}

class LiveLearner : public ::testing::Test {
 protected:
  LiveLearner()
      : participant_(test::make_participant()),
        scans_(participant_, "/labeled_scan", bus::qos_profile("lossless")),
        bases_(participant_, "/reflection_filtered", bus::qos_profile("latched")),
        trajectories_(participant_, "/trajectory", bus::qos_profile("latched")),
        maps_(participant_, "/patch_map", "latched"),
        watch_(participant_) {
    register_component(registry_);
    host_ = test::make_host(
        "{type: strata::PatchLearner, name: learner, parameters: {online: {publish_every_s: 0}}}",
        registry_, test::make_participant());
    host_->activate();
    EXPECT_TRUE(scans_.raw().wait_for_readers(1, std::chrono::seconds(20)));
  }
  void publish(const PosedScan& scan) { scans_.publish(convert::to_message(scan, "map", "laser")); }
  void publish_base(const std::vector<PosedScan>& scans) {
    CountingMap counts(0.05);
    for (const PosedScan& scan : scans) counts.add(scan);
    bases_.publish(convert::to_message(counts.reflection()));
  }
  /// Until the learner has the map it keeps few scans.
  void bring_base(const std::vector<PosedScan>& scans) {
    publish_base(scans);
    ASSERT_TRUE(says("received /reflection_filtered", "1"));
  }
  void publish_trajectory(const std::vector<PosedScan>& scans) {
    nav_msgs::msg::Path path;
    path.header(convert::make_header({}, "map"));
    for (const PosedScan& scan : scans) {
      geometry_msgs::msg::PoseStamped pose;
      pose.header(convert::make_header(scan.scan.stamp, "map"));
      pose.pose(convert::to_pose(scan.map_from_robot));
      path.poses().push_back(pose);
    }
    trajectories_.publish(path);
  }
  /// Waits until a status says so of a key; whether one did.
  bool says(const std::string& key, const std::string& value) {
    return test::value_of(watch_.wait_for(*host_,
                                          [&](const auto& status) {
                                            return test::value_of(status, key) == value;
                                          }),
                          key) == value;
  }

  runtime::Registry registry_;
  std::shared_ptr<bus::Participant> participant_;
  bus::Writer<strata_msgs::msg::LabeledScan> scans_;
  bus::Writer<strata_msgs::msg::ReflectionGrid> bases_;
  bus::Writer<nav_msgs::msg::Path> trajectories_;
  test::Collector<strata_msgs::msg::PatchMap> maps_;
  test::StatusWatch watch_;
  std::unique_ptr<runtime::Host> host_;
};

TEST_F(LiveLearner, KeepsScansThatComeBeforeTheFirstMap) {
  const auto scans = drives(1);
  ASSERT_LT(scans.size(), 200U);
  for (const PosedScan& scan : scans) publish(scan);
  EXPECT_TRUE(says("received /labeled_scan", std::to_string(scans.size())));
  publish_base(scans);
  EXPECT_TRUE(says("scans", std::to_string(scans.size())));
  const auto maps = maps_.wait_for(1);
  ASSERT_FALSE(maps.empty()) << "who localizes needs it, though nothing has changed yet";
  EXPECT_TRUE(maps[0].submaps().empty());
}

TEST_F(LiveLearner, TakesOverTheMapAsItGrows) {
  const auto scans = drives(1);
  publish_base({scans.front()});
  publish(scans.front());
  ASSERT_EQ(maps_.wait_for(1).size(), 1U);
  publish_base(scans);
  // What was told a moment ago is not made anew at once.
  std::vector<strata_msgs::msg::PatchMap> maps;
  ASSERT_TRUE(test::comes_true([&] {
    host_->tick();
    maps = maps_.wait_for(2, std::chrono::milliseconds(50));
    return maps.size() == 2;
  }));
  EXPECT_GT(convert::from_message(maps[1]).base.size(), convert::from_message(maps[0]).base.size());
}

TEST_F(LiveLearner, LearnsAnewWhereALoopClosureHasMovedScans) {
  const auto right = drives(6);
  bring_base(right);
  for (const PosedScan& scan : right) publish(drifted(scan));
  ASSERT_TRUE(says("scans", std::to_string(right.size())));
  ASSERT_TRUE(says("times that loop closures moved scans", "0"));
  publish_trajectory(right);
  ASSERT_TRUE(says("times that loop closures moved scans", "1"));
  EXPECT_TRUE(says("sub-maps", "1"));
  // However many maps came before it.
  EXPECT_TRUE(test::comes_true([&] {
    host_->tick();
    const auto maps = maps_.wait_for(1);
    if (maps.empty()) return false;
    const auto submaps = convert::from_message(maps.back()).submaps;
    return submaps.size() == 1 && submaps[0].configurations.size() == 2;
  })) << "the door, closed and open";
  // The same trajectory once more moves nothing.
  publish_trajectory(right);
  ASSERT_TRUE(says("received /trajectory", "2"));
  EXPECT_TRUE(says("times that loop closures moved scans", "1"));
}

// Without another run no visit would end, and nothing be looked for, before the clock has caught
// up.
TEST_F(LiveLearner, LearnsOnWhenTheClockIsSetBack) {
  auto scans = drives(6);
  for (PosedScan& scan : scans) {
    const double back_s = scan.scan.stamp.seconds() < 100.0 ? 0.0 : 90'000.0;
    scan.scan.stamp = scan.scan.stamp + Duration::from_seconds(100'000.0 - back_s);
  }
  bring_base(scans);
  for (const PosedScan& scan : scans) publish(scan);
  ASSERT_TRUE(says("scans", std::to_string(scans.size())));
  EXPECT_TRUE(says("sub-maps", "1")) << "the door, closed and open";
}

TEST_F(LiveLearner, LeavesOutAnAreaInWhichNothingReturnsAndSaysSo) {
  const auto scans = patch::test_world::drive_past_box({0, 1, 2, 3, 4, -1, 0, 1}, 2,
                                                       patch::test_world::Visits::kOneRun);
  const auto returning = scans.end() - static_cast<std::ptrdiff_t>(scans.size() / 4);
  bring_base(scans);
  // The seventh drive ends the sequence of the sixth.
  for (auto scan = scans.begin(); scan != returning; ++scan) publish(*scan);
  publish(*returning);
  ASSERT_TRUE(says("scans", std::to_string(returning - scans.begin() + 1)));
  EXPECT_TRUE(says("sub-maps", "0"));
  EXPECT_TRUE(says("areas left out, where nothing returns", "1"));
}

TEST_F(LiveLearner, LearnsThatAGateOntoNothingIsOpenThoughScansAreLostAndRepeated) {
  const auto scans = patch::test_world::drive_past_gate(patch::test_world::kGateOfEightDays,
                                                        patch::test_world::Visits::kOneRun);
  bring_base(scans);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (i % 11 == 5) continue;
    publish(scans[i]);
    if (i % 13 == 7) publish(scans[i]);
  }
  EXPECT_TRUE(test::comes_true([&] {
    host_->tick();
    const auto maps = maps_.wait_for(1);
    return !maps.empty() && patch::test_world::gates_of(convert::from_message(maps.back())) == 1;
  }));
}

TEST_F(LiveLearner, LearnsFromScansThatComeWhileItLearnsAgain) {
  auto right = drives(6);
  const auto later = right.end() - static_cast<std::ptrdiff_t>(right.size() / 6);
  bring_base(right);
  for (auto scan = right.begin(); scan != later; ++scan) publish(drifted(*scan));
  publish_trajectory(right);
  for (auto scan = later; scan != right.end(); ++scan) publish(drifted(*scan));
  ASSERT_TRUE(says("scans", std::to_string(right.size())));
  ASSERT_TRUE(says("times that loop closures moved scans", "1"));
  EXPECT_TRUE(says("scans", std::to_string(right.size()))) << "none lost, none twice";
  EXPECT_TRUE(says("sub-maps", "1"));
}

TEST_F(LiveLearner, SetsAsideWhatItLearnedInTheFrameOfAMapperThatBeganAnew) {
  const test::TemporaryDirectory folder;
  const auto begin_again = [&] {
    host_.reset();
    host_ = test::make_host(
        "{type: strata::PatchLearner, name: learner, parameters: {online: {publish_every_s: 0, "
        "store: {folder: '" +
            folder.path().string() + "'}}}}",
        registry_, test::make_participant());
    host_->activate();
  };
  const auto right = drives(2);
  begin_again();
  publish_base(right);
  // Until it hears them, they are lost.
  ASSERT_TRUE(test::comes_true([&] {
    publish(right.front());
    host_->tick();
    return host_->components().front()->counts().processed > 2;
  }));
  for (const PosedScan& scan : right) publish(scan);
  ASSERT_TRUE(test::comes_true([&] {
    host_->tick();
    return host_->components().front()->counts().processed >= right.size();
  }));
  begin_again();  // in the same map
  ASSERT_TRUE(
      test::comes_true([&] { return host_->components().front()->counts().processed > 0; }));
  EXPECT_TRUE(host_->take_errors().empty());
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "learner.state.damaged"));
  std::vector<PosedScan> elsewhere = right;
  for (PosedScan& scan : elsewhere)
    scan.map_from_robot = Pose2{3.0, 2.0, 1.0} * scan.map_from_robot;
  publish_base(elsewhere);
  ASSERT_TRUE(says("received /reflection_filtered", "2"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "learner.state.damaged")) << "it only grew";
  begin_again();
  ASSERT_TRUE(test::comes_true(
      [&] { return std::filesystem::exists(folder.path() / "learner.state.damaged"); }));
}

}  // namespace
}  // namespace strata::patch_learner
