// SPDX-License-Identifier: Apache-2.0
/// A small room's maps, a second day in it, and a localizer for both.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "components/maps/maps_folder.hpp"
#include "components/runtime/composition.hpp"
#include "components/settings/yaml_document.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/simulate/two_days.hpp"
#include "tools/pipeline/learn.hpp"

namespace strata::localizer {

inline constexpr std::uint64_t kSeed = 7;

/// Maps of the small room's first day, and the second day to be localized on.
struct Room {
  test::TemporaryDirectory folder;
  std::vector<Observation> observations;
  std::vector<Pose2> truth;  ///< map_from_robot at each
  Pose2 start;
};

inline const Room& room() {
  static const std::unique_ptr<const Room> made = [] {
    auto room = std::make_unique<Room>();
    const test::TwoDays days = test::two_days(STRATA_SCENARIO_DIR "/empty_room.yaml", 1);
    room->observations = days.second;
    room->truth = days.second_poses;
    room->start = room->truth.front();
    const pipeline::LearnResult learned = pipeline::learn(
        days.first, days.first_poses, {}, {.patch = true, .timescale = true}, kSeed, 1, nullptr);
    maps::write_grid_maps(room->folder.path(), learned.slam);
    maps::write_patch_map(room->folder.path(), learned.patches);
    maps::write_timescale(room->folder.path(), *learned.timescale);
    return room;
  }();
  return *made;
}

inline runtime::Composition composition_of(const std::string& parameters) {
  return runtime::read_composition(
      settings::parse_yaml("{domain: " + std::to_string(test::own_domain()) +
                               ", transport: loopback, processes: [{name: main, components: "
                               "[{type: strata::Localizer, name: localizer, parameters: " +
                               parameters + "}]}]}",
                           "test"),
      "test");
}

inline std::string parameters_of(const std::string& model, bool global) {
  std::ostringstream text;
  text.precision(17);
  text << "{maps: '" << room().folder.path().string() << "', model: " << model;
  const Pose2& start = room().start;
  if (!global) {
    text << ", start: {pose: [" << start.x << ", " << start.y << ", " << start.theta << "]}";
  } else {
    text << ", localizer: {global_start: {max_particles: 3000}}";
  }
  text << "}";
  return text.str();
}

}  // namespace strata::localizer
