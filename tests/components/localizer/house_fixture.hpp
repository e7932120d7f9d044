// SPDX-License-Identifier: Apache-2.0
/// A house with a lift between two levels, and a robot that rides in it.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/site/site.hpp"
#include "tests/components/localizer/site_fixture.hpp"
#include "tools/laboratory/experiments/lift_building.hpp"
#include "tools/pipeline/compare_config.hpp"

namespace strata::localizer {

inline constexpr const char* kLift =
    R"({"type": "Feature", "properties": {"name": "lift", "kind": "lift"}, "geometry": {"type":
    "Polygon", "coordinates": [[[-0.9,-2],[0.9,-2],[0.9,0],[-0.9,0],[-0.9,-2]]]}})";

/// Two levels, mapped, and a ride from the lower to the upper one.
struct House {
  test::TemporaryDirectory folder;
  fs::path site;
  experiments::Ride ride;
};

inline const House& house() {
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

/// What the robot sees on its ride.
inline std::vector<Observation> seen_on_ride() {
  std::vector<Observation> seen;
  for (const auto& scan : house().ride.scans) seen.push_back(scan.observation);
  return seen;
}

/// In the house, from where the ride begins.
inline std::string parameters_on_ride(const std::string& start, const fs::path& maps) {
  return "{maps: '" + maps.string() + "', model: filtered, start: {" + start + "}}";
}
inline std::string start_of_ride() {
  const Pose2& at = house().ride.scans.front().truth;
  return "level: '0', pose: [" + std::to_string(at.x) + ", " + std::to_string(at.y) + ", " +
         std::to_string(at.theta) + "]";
}

}  // namespace strata::localizer
