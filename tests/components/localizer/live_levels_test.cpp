// SPDX-License-Identifier: Apache-2.0
/// A robot that rides in a lift, over DDS, with the scans at a pace of their own.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "components/bus/site_service_types.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/localizer/register.hpp"
#include "components/player/log_player.hpp"
#include "components/runtime/host.hpp"
#include "components/site/site.hpp"
#include "tests/components/localizer/room_fixture.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/comes_true.hpp"
#include "tools/laboratory/experiments/lift_building.hpp"
#include "tools/pipeline/compare_config.hpp"

namespace strata::localizer {
namespace {

namespace fs = std::filesystem;
using strata_msgs::msg::SiteLevel;
using testing::HasSubstr;

const site::Actor kAda{"ada", 1'000'000'000};
constexpr const char* kLift =
    R"({"type": "Feature", "properties": {"name": "lift", "kind": "lift"}, "geometry": {"type":
    "Polygon", "coordinates": [[[-0.9,-2],[0.9,-2],[0.9,0],[-0.9,0],[-0.9,-2]]]}})";

/// Two levels, mapped, and a ride from the lower to the upper one.
struct House {
  test::TemporaryDirectory folder;
  fs::path site;
  experiments::Ride ride;
};

const House& house() {
  static const std::unique_ptr<const House> made = [] {
    auto house = std::make_unique<House>();
    house->site = house->folder.path() / "house";
    site::Site building = site::Site::create(house->site, "house", "map", kAda);
    experiments::LiftBuilding floors;
    for (const std::string name : {"0", "1"}) {
      const std::uint64_t seed = 31 + floors.floors.size();
      experiments::LiftFloor floor;
      floor.scenario = experiments::lift_floor(seed, seed);
      floor.scenario.days = 1;
      const auto simulation = simulate::simulate(floor.scenario, seed);
      floor.walls = simulation.walls;
      std::vector<Observation> seen;
      std::vector<std::optional<Pose2>> poses;
      for (const auto& scan : simulation.days[0].scans) {
        seen.push_back(scan.observation);
        poses.emplace_back(scan.map_from_robot);
      }
      const auto learned = pipeline::learn(seen, poses, pipeline::learn_at_given_poses(),
                                           {.patch = false, .timescale = false}, kSeed, 1, nullptr);
      const fs::path maps = house->folder.path() / ("maps-" + name);
      maps::write_grid_maps(maps, learned.slam);
      const double elevation_m = name == "0" ? 0.0 : 3.5;
      site::Site level(building.add_level(name, elevation_m, "house-" + name, kAda).folder);
      const std::string hash = level.add(maps, kAda, "").status.version.hash;
      level.approve(hash, kAda, "");
      (void)level.activate(hash, kAda);
      floors.floors.push_back(std::move(floor));
    }
    (void)building.change_zones(
        [](site::Zones& zones) { zones = site::parse_zones(kLift, "lift"); }, kAda, "drawn");
    house->ride = experiments::ride(floors, 0, 1, 5);
    return house;
  }();
  return *made;
}

class LiveLevels : public testing::Test {
 protected:
  LiveLevels() {
    player::Outputs outputs;
    outputs.clock = [](const auto&) {};
    outputs.tf_static = [this](const auto& message) { tf_static_.publish(message); };
    outputs.tf = [this](const auto& message) { tf_.publish(message); };
    outputs.odometry = [this](const auto& message) { odometry_.publish(message); };
    outputs.scan = [this](const auto& message) { scan_.publish(message); };
    std::vector<Observation> seen;
    for (const auto& scan : house().ride.scans) seen.push_back(scan.observation);
    player_.emplace(std::move(seen), outputs);
  }

  void start(const std::string& start, const fs::path& maps = house().site) {
    host_.reset();
    const runtime::Composition composition =
        composition_of("{maps: '" + maps.string() + "', model: filtered, start: {" + start + "}}");
    runtime::Registry registry;
    register_component(registry);
    host_ = std::make_unique<runtime::Host>(composition, composition.processes[0], registry,
                                            runtime::make_participant(composition),
                                            runtime::HostOptions{.seed = kSeed});
    host_->activate();
  }
  [[nodiscard]] static std::string start_pose() {
    const Pose2& at = house().ride.scans.front().truth;
    return "pose: [" + std::to_string(at.x) + ", " + std::to_string(at.y) + ", " +
           std::to_string(at.theta) + "]";
  }
  /// Publishes some times as fast as they were taken, whoever listens.
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
  [[nodiscard]] std::string status(const std::string& key, const std::string& wanted) {
    std::string said;
    (void)test::comes_true([&] {
      host_->tick();
      const auto all = diagnostics_.wait_for(0);
      if (all.empty()) return false;
      for (const auto& one : all.back().status()) said = runtime::value_of(one, key);
      return said == wanted;
    });
    return said;
  }

  std::shared_ptr<bus::Participant> robot_ = test::make_participant();
  bus::Writer<tf2_msgs::msg::TFMessage> tf_static_{robot_, "/tf_static",
                                                   bus::qos_profile("latched")};
  bus::Writer<tf2_msgs::msg::TFMessage> tf_{robot_, "/tf", bus::qos_profile("tf")};
  bus::Writer<nav_msgs::msg::Odometry> odometry_{robot_, "/odom", bus::qos_profile("default")};
  bus::Writer<sensor_msgs::msg::LaserScan> scan_{robot_, "/scan", bus::qos_profile("default")};
  test::Collector<SiteLevel> levels_{robot_, "/localizer/level", "latched"};
  test::Collector<diagnostic_msgs::msg::DiagnosticArray> diagnostics_{robot_, "/diagnostics",
                                                                      "default"};
  test::Collector<geometry_msgs::msg::PoseWithCovarianceStamped> poses_{robot_, "/amcl_pose",
                                                                        "default"};
  std::optional<player::LogPlayer> player_;
  std::unique_ptr<runtime::Host> host_;
};

TEST_F(LiveLevels, RideOverTheBusAndAreToldWithinThreeSecondsOfTheDoor) {
  start("level: '0', " + start_pose());
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
  start("");
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
  start("level: '0', " + start_pose(), own);
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
