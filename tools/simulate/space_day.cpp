// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/space_day.hpp"

#include <cmath>

namespace strata::simulate {
namespace {

/// Streams of the 3-D scanner begin here, those of the planar one at 0.
constexpr std::uint32_t kFirstSpaceStream = 1U << 20;

/// Whole milliseconds, as the stamps of scans.
Stamp stamp_of(const SpaceDay& day, double time_s) {
  return Stamp::from_seconds(std::round((day.start_s + time_s) * 1e3) * 1e-3);
}

Space space_at(const ScenarioConfig& scenario, const SpaceDay& day, double time_s) {
  std::vector<LevelFace> changeable;
  for (const ChangeableObject& object : day.objects) {
    const double height = object.kind == "box" ? scenario.heights.box_m : scenario.heights.door_m;
    changeable.push_back(
        {object.shapes[object.state_at(day.day, time_s)], height, BeamSource::kChangeable});
  }
  const Pose2 robot = day.map_from_robot(time_s);
  return make_space(scenario, day.still, day.first_block_side, changeable,
                    day.people->legs_at(time_s, robot.translation()));
}

}  // namespace

std::vector<SimulatedCloud> clouds_of(const ScenarioConfig& scenario, const SpaceDay& day,
                                      std::uint64_t seed) {
  const Scanner3Config& scanner = scenario.scanner3;
  std::vector<SimulatedCloud> clouds;
  if (scanner.rate_hz <= 0.0) return clouds;
  const bool is_tilting = scanner.kind == Scanner3Kind::kTilting;
  const double sweep_s = is_tilting ? scanner.sweep_s : 0.0;
  const Pose3 robot_from_sensor = robot_from_scanner(scanner);
  for (std::size_t number = 0;; ++number) {
    const double begin_s = static_cast<double>(number) / scanner.rate_hz;
    if (begin_s + sweep_s > day.length_s) break;
    SimulatedCloud cloud;
    cloud.stamp = stamp_of(day, begin_s);
    RandomStream random(seed, StreamId::kSimulatorSensor, number,
                        kFirstSpaceStream + static_cast<std::uint32_t>(day.day));
    Space space = space_at(scenario, day, begin_s);
    for (int layer = 0; layer < scanner.layers; ++layer) {
      const double offset_s = sweep_s * layer / scanner.layers;
      if (is_tilting && layer > 0) space = space_at(scenario, day, begin_s + offset_s);
      const Pose3 map_from_scanner =
          lift(day.map_from_robot(begin_s + offset_s)) * robot_from_sensor;
      scan_layer(scanner, layer, space, map_from_scanner, offset_s, random, cloud);
    }
    clouds.push_back(std::move(cloud));
  }
  return clouds;
}

std::vector<SimulatedImage> images_of(const ScenarioConfig& scenario, const SpaceDay& day) {
  const CameraConfig& camera = scenario.camera;
  std::vector<SimulatedImage> images;
  if (camera.rate_hz <= 0.0) return images;
  for (std::size_t number = 0;; ++number) {
    const double time_s = static_cast<double>(number) / camera.rate_hz;
    if (time_s > day.length_s) break;
    const Pose3 map_from_camera = lift(day.map_from_robot(time_s)) * robot_from_camera(camera);
    images.push_back({stamp_of(day, time_s),
                      take_image(camera, space_at(scenario, day, time_s), map_from_camera)});
  }
  return images;
}

}  // namespace strata::simulate
