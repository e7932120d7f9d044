// SPDX-License-Identifier: Apache-2.0
/// A robot that rides in a lift, over DDS, with the scans at a pace of their own.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "components/bus/site_service_types.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/site/site.hpp"
#include "tests/components/localizer/house_fixture.hpp"

namespace strata::localizer {
namespace {

using strata_msgs::msg::SiteLevel;
using testing::HasSubstr;

class LiveLevels : public LiveLocalizer {
 protected:
  LiveLevels() : LiveLocalizer(seen_on_ride()) {}

  void begin(const std::string& start, const fs::path& maps = house().site) {
    LiveLocalizer::start(parameters_on_ride(start, maps));
  }
  /// At a pace of its own, four times that of the scanner, whoever listens.
  void play(std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      player_->publish(i);
      std::this_thread::sleep_for(std::chrono::milliseconds(25));
      if (i % 4 == 0) host_->tick();
    }
  }
  [[nodiscard]] bool is_told(const std::string& level, bool certain) {
    return test::comes_true([&] {
      host_->tick();
      const auto all = levels_.wait_for(0);
      return !all.empty() && all.back().level() == level && all.back().certain() == certain;
    });
  }
  [[nodiscard]] auto set_level(const std::string& level) {
    strata_msgs::srv::SetSiteLevel_Request request;
    request.level(level);
    return bus::call_service<bus::srv::SetSiteLevel>(robot_, "/localizer/set_level", request,
                                                     std::chrono::seconds(30));
  }

  test::Collector<SiteLevel> levels_{robot_, "/localizer/level", "latched"};
};

TEST_F(LiveLevels, RideOverTheBusAndAreToldWithinThreeSecondsOfTheDoor) {
  begin(start_of_ride());
  const auto& scans = house().ride.scans;
  play(0, scans.size());
  ASSERT_TRUE(is_told("1", true));
  const auto told = levels_.wait_for(0);
  const auto opening = std::find_if(scans.begin(), scans.end(),
                                    [](const auto& scan) { return scan.least_difference >= 0.05; });
  ASSERT_NE(opening, scans.end());
  const Stamp opened = opening->observation.scan.stamp;
  EXPECT_EQ(told.front().level(), "0");
  EXPECT_TRUE(told.front().certain());
  const auto arrived = std::find_if(told.begin(), told.end(), [](const SiteLevel& level) {
    return level.level() == "1" && level.certain();
  });
  ASSERT_NE(arrived, told.end());
  EXPECT_LE((convert::from_message(arrived->header().stamp()) - opened).seconds(), 3.0);
  for (auto one = arrived; one != told.end(); ++one) EXPECT_EQ(one->level(), "1");
  EXPECT_TRUE(std::any_of(told.begin(), arrived, [](const SiteLevel& level) {
    return level.in_lift() && !level.certain() && level.candidates().size() == 2;
  }));
  EXPECT_EQ(told.back().map_id(), "house-1");
  EXPECT_EQ(told.back().elevation(), 3.5);
  EXPECT_EQ(status("mapId", "house-1"), "house-1");
  EXPECT_EQ(status("level_certain", "true"), "true");
  const auto pose = poses_.wait_for(1).back();
  EXPECT_LT(
      translation_distance(planar(convert::from_message(pose.pose().pose())), scans.back().truth),
      0.5);
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(LiveLevels, AreFoundFromNowhereAndToldByHand) {
  begin("");
  const auto& scans = house().ride.scans;
  std::size_t out = scans.size() - 1;
  while (scans[out].truth.y > 0.5) --out;
  play(out, scans.size());
  EXPECT_TRUE(is_told("1", true));
  const auto refused = set_level("7");
  ASSERT_TRUE(refused);
  EXPECT_FALSE(refused->success());
  EXPECT_THAT(refused->message(), HasSubstr("choose among 0, 1"));
  const auto taken = set_level("0");
  ASSERT_TRUE(taken);
  EXPECT_TRUE(taken->success()) << taken->message();
  play(out, out + 3);
  EXPECT_TRUE(is_told("0", true));
  EXPECT_EQ(status("mapId", "house-0"), "house-0");
}

TEST_F(LiveLevels, TakeAnotherVersionOfALevelAndLiftsThatAreDrawnAnewWhileTheyDrive) {
  const test::TemporaryDirectory folder;
  const fs::path own = folder.path() / "house";
  fs::copy(house().site, own, fs::copy_options::recursive | fs::copy_options::copy_symlinks);
  begin(start_of_ride(), own);
  play(0, 20);
  EXPECT_EQ(status("mapVersion", "1"), "1");
  const fs::path maps = folder.path() / "maps";
  fs::copy(own / "levels/0/active/", maps, fs::copy_options::recursive);
  std::ofstream(maps / "trajectory.tum", std::ios::app) << "\n";
  site::Site level(own / "levels/0");
  const std::string hash = level.add(maps, kAda, "").status.version.hash;
  level.approve(hash, kAda, "");
  (void)level.activate(hash, kAda);
  EXPECT_EQ(status("mapHash", hash), hash);
  EXPECT_EQ(status("mapId", "house-0"), "house-0");
  // A lift as large as the level.
  std::string lift = kLift;
  lift = lift.substr(0, lift.find("[[[")) + "[[[-20,-2],[20,-2],[20,3],[-20,3],[-20,-2]]]}}";
  (void)site::Site(own).change_zones(
      [&](site::Zones& zones) { zones = site::parse_zones(lift, "lift"); }, kAda, "drawn");
  std::size_t next = 20;
  EXPECT_TRUE(test::comes_true([&] {
    host_->tick();
    if (next < house().ride.scans.size()) play(next, next + 1);
    ++next;
    const auto all = levels_.wait_for(0);
    return !all.empty() && all.back().in_lift();
  }));
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(LiveLevels, TakeANewVersionThoughAnotherLevelsIsDamaged) {
  const test::TemporaryDirectory folder;
  const fs::path own = folder.path() / "house";
  fs::copy(house().site, own, fs::copy_options::recursive | fs::copy_options::copy_symlinks);
  begin(start_of_ride(), own);
  play(0, 20);
  std::map<std::string, std::string> hashes;
  for (const std::string name : {"0", "1"}) {
    const fs::path maps = folder.path() / ("maps-" + name);
    fs::copy(own / "levels" / name / "active/", maps, fs::copy_options::recursive);
    std::ofstream(maps / "trajectory.tum", std::ios::app) << "\n";
    site::Site level(own / "levels" / name);
    hashes[name] = level.add(maps, kAda, "").status.version.hash;
    level.approve(hashes[name], kAda, "");
    (void)level.activate(hashes[name], kAda);
  }
  std::ofstream(own / "levels/1/active/trajectory.tum", std::ios::app) << "\n";
  EXPECT_EQ(status("mapHash", hashes["0"]), hashes["0"]);
  EXPECT_THAT(host_->take_errors(), testing::Contains(HasSubstr("levels/1")));
}

/// A house whose upper level nobody has mapped yet.
class LiveLevelsWithoutMaps : public LiveLevels {
 protected:
  LiveLevelsWithoutMaps() {
    fs::copy(house().site, own_, fs::copy_options::recursive | fs::copy_options::copy_symlinks);
    fs::remove(own_ / "levels/1/active");
  }
  test::TemporaryDirectory folder_;
  fs::path own_ = folder_.path() / "house";
};

TEST_F(LiveLevelsWithoutMaps, AreNoPlaceToBeginOn) {
  const std::string start = start_of_ride();
  std::string error;
  try {
    begin("level: '1'" + start.substr(start.find(',')), own_);
  } catch (const InputError& refused) {
    error = refused.what();
  }
  EXPECT_THAT(error, HasSubstr("start.level: level '1' has no active version"));
  EXPECT_THAT(error, HasSubstr("strata site activate SITE/levels/1"));
}

TEST_F(LiveLevelsWithoutMaps, LeaveTheLevelOpenToARobotThatWasThere) {
  const fs::path kept = folder_.path() / "pose.yaml";
  std::ofstream(kept)
      << "{version: 1, map_from_robot: [1, 2, 0], covariance: [1, 0, 0, 0, 1, 0, 0, 0, 1], "
         "odom_from_robot: [], stamp_ns: 1000000000, level: '1'}";
  begin(start_of_ride() + ", store: {file: '" + kept.string() + "'}", own_);
  EXPECT_THAT(host_->take_errors(),
              testing::Contains(HasSubstr("the robot was on level '1', which has no active")));
  play(0, 30);
  EXPECT_TRUE(is_told("0", false));
  for (const SiteLevel& level : levels_.wait_for(0)) EXPECT_FALSE(level.certain());
  const auto taken = set_level("0");
  ASSERT_TRUE(taken);
  EXPECT_TRUE(taken->success()) << taken->message();
  play(30, 33);
  EXPECT_TRUE(is_told("0", true));
}

TEST_F(LiveLevels, OfNoneWithMapsAreRefused) {
  const fs::path empty = house().folder.path() / "empty";
  fs::remove_all(empty);
  (void)site::Site::create(empty, "empty", "map", kAda).add_level("0", 0.0, "empty-0", kAda);
  const runtime::Composition composition = composition_of("{maps: '" + empty.string() + "'}");
  runtime::Registry registry;
  register_component(registry);
  try {
    runtime::Host host(composition, composition.processes[0], registry,
                       runtime::make_participant(composition), {.seed = kSeed});
    host.activate();
    FAIL() << "it began";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no level with an active version"));
  }
}

}  // namespace
}  // namespace strata::localizer
