// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/space_log.hpp"

#include <algorithm>
#include <string>

#include "components/clouds/image_messages.hpp"
#include "components/convert/cdr.hpp"
#include "components/convert/cloud_messages.hpp"

namespace strata::simulate {
namespace {

constexpr const char* kScannerFrame = "scanner3";
constexpr const char* kCameraFrame = "camera_optical";

std::size_t add_topic(log::LogExtras& extras, const std::string& name, const std::string& type) {
  extras.topics.push_back({name, "sensor_msgs/msg/" + type, "cdr", log::recorded_qos()});
  return extras.topics.size() - 1;
}

void add_clouds(const Simulation& simulation, const SimulatedDay& day, std::size_t topic,
                log::LogExtras& extras) {
  const Scanner3Config& scanner = simulation.scenario.scanner3;
  const bool is_tilting = scanner.kind == Scanner3Kind::kTilting;
  for (const SimulatedCloud& cloud : day.clouds) {
    convert::CloudColumns columns;
    if (is_tilting) columns.offset_s = cloud.offset_s;
    for (const BeamSource source : cloud.sources) {
      columns.truly_moving.push_back(source == BeamSource::kPerson ? 1 : 0);
    }
    // A bag holds a cloud when it is whole.
    const Stamp whole = cloud.stamp + Duration::from_seconds(is_tilting ? scanner.sweep_s : 0.0);
    extras.messages.push_back({topic, whole,
                               convert::to_cdr(convert::to_message(cloud.points_m, cloud.stamp,
                                                                   kScannerFrame, columns))});
  }
}

volume::ColorImage to_color_image(const report::Image& image) {
  volume::ColorImage result{image.width(), image.height(), {}};
  for (const report::Color& pixel : image.pixels()) {
    result.pixels.push_back({pixel.r, pixel.g, pixel.b});
  }
  return result;
}

void add_images(const CameraConfig& config, const SimulatedDay& day, std::size_t info,
                std::size_t image, log::LogExtras& extras) {
  volume::Camera camera;
  camera.width = config.width;
  camera.height = config.height;
  camera.focal_x = camera.focal_y = focal_pixels(config);
  camera.middle_x = 0.5 * config.width - 0.5;
  camera.middle_y = 0.5 * config.height - 0.5;
  for (const SimulatedImage& taken : day.images) {
    extras.messages.push_back(
        {info, taken.stamp,
         convert::to_cdr(convert::to_message(camera, taken.stamp, kCameraFrame))});
    extras.messages.push_back({image, taken.stamp,
                               convert::to_cdr(convert::to_message(to_color_image(taken.image),
                                                                   taken.stamp, kCameraFrame))});
  }
}

}  // namespace

log::LogExtras space_messages(const Simulation& simulation, std::size_t first, std::size_t last) {
  const ScenarioConfig& scenario = simulation.scenario;
  log::LogExtras extras;
  if (scenario.scanner3.rate_hz > 0.0) {
    extras.mountings.push_back({kScannerFrame, robot_from_scanner(scenario.scanner3)});
    const std::size_t topic = add_topic(extras, "/points", "PointCloud2");
    for (std::size_t day = first; day < last; ++day) {
      add_clouds(simulation, simulation.days[day], topic, extras);
    }
  }
  if (scenario.camera.rate_hz > 0.0) {
    extras.mountings.push_back({kCameraFrame, robot_from_camera(scenario.camera)});
    const std::size_t info = add_topic(extras, "/camera/camera_info", "CameraInfo");
    const std::size_t image = add_topic(extras, "/camera/image_raw", "Image");
    for (std::size_t day = first; day < last; ++day) {
      add_images(scenario.camera, simulation.days[day], info, image, extras);
    }
  }
  std::stable_sort(
      extras.messages.begin(), extras.messages.end(),
      [](const log::BagMessage& a, const log::BagMessage& b) { return a.stamp < b.stamp; });
  return extras;
}

}  // namespace strata::simulate
