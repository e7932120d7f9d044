// SPDX-License-Identifier: Apache-2.0
#include "components/map_saver/map_saver.hpp"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <filesystem>
#include <limits>
#include <mutex>

#include "components/convert/map_messages.hpp"
#include "components/log/map_file.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::map_saver {
namespace {

/// What nav2's map_saver takes when the request names none.
constexpr float kFreeThreshold = 0.25F;
constexpr float kOccupiedThreshold = 0.65F;

/// Occupied, free or unknown, as mode trinary has it.
void make_trinary(ReflectionGrid& map, float free, float occupied) {
  for (float& cell : map.values()) {
    if (!is_known(cell)) continue;
    if (cell >= occupied) {
      cell = 1.0F;
    } else if (cell <= free) {
      cell = 0.0F;
    } else {
      cell = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Image and mode that are asked for; left empty, they are nav2's.
log::MapFileFormat format_of(const nav2_msgs::srv::SaveMap_Request& request,
                             const std::string& place) {
  log::MapFileFormat format;
  const std::string mode = lower(request.map_mode());
  const std::optional<log::MapMode> known = log::map_mode(mode.empty() ? "trinary" : mode);
  if (!known) {
    throw InputError(place, "map_mode is '" + mode + "'", "ask for trinary, scale or raw");
  }
  format.mode = *known;
  const std::string image = lower(request.image_format());
  const bool is_png = image == "png" || (image.empty() && format.mode == log::MapMode::kScale);
  if (!is_png && !image.empty() && image != "pgm") {
    throw InputError(place, "image_format is '" + image + "'", "ask for pgm or png");
  }
  format.image = is_png ? log::MapImageFormat::kPng : log::MapImageFormat::kPgm;
  return format;
}

/// The request has floats: 0.65 comes as 0.649999976, and is to be written as it was meant.
double as_meant(float threshold) { return std::round(static_cast<double>(threshold) * 1e6) / 1e6; }

float threshold_or(float asked, float standard) { return asked == 0.0F ? standard : asked; }

}  // namespace

void MapSaver::on_configure() {
  config_ = read_parameters<MapSaverConfig>();
  keep_live(config_, {"folder", "topic", "save_map_timeout_s", "map_subscribe_transient_local"});
  offer<bus::srv::SaveMap>("~/save_map", [this](const auto& request) {
    nav2_msgs::srv::SaveMap_Response response;
    response.result(false);  // also when what follows throws
    if (state() != runtime::LifecycleState::kActive) return response;
    save(request);
    response.result(true);
    return response;
  });
}

std::optional<nav_msgs::msg::OccupancyGrid> MapSaver::wait_for_map(const std::string& topic) const {
  std::mutex mutex;
  std::condition_variable changed;
  std::optional<nav_msgs::msg::OccupancyGrid> map;
  const auto qos = bus::qos_profile(config_.map_subscribe_transient_local ? "latched" : "default");
  const bus::Reader<nav_msgs::msg::OccupancyGrid> reader(context().participant, topic, qos,
                                                         [&](const auto& message) {
                                                           const std::lock_guard lock(mutex);
                                                           map = message;
                                                           changed.notify_all();
                                                         });
  std::unique_lock lock(mutex);
  changed.wait_for(lock, std::chrono::duration<double>(config_.save_map_timeout_s),
                   [&] { return map.has_value(); });
  return map;
}

void MapSaver::save(const nav2_msgs::srv::SaveMap_Request& request) const {
  const std::string place = resolve("~/save_map");
  if (request.map_url().empty()) {
    throw InputError(place, "map_url is empty", "name the files, without extension");
  }
  log::MapFileFormat format = format_of(request, place);
  const float free = threshold_or(request.free_thresh(), kFreeThreshold);
  const float occupied = threshold_or(request.occupied_thresh(), kOccupiedThreshold);
  if (!(free >= 0.0F && free < occupied && occupied <= 1.0F)) {
    throw InputError(place, "the thresholds are not 0 <= free_thresh < occupied_thresh <= 1",
                     "leave both 0 for 0.25 and 0.65");
  }
  const std::string topic =
      resolve(request.map_topic().empty() ? config_.topic : request.map_topic());
  const auto message = wait_for_map(topic);
  if (!message) {
    throw InputError(place, "no map came on " + topic,
                     config_.map_subscribe_transient_local
                         ? "see with `strata doctor` whether it is published, latched"
                         : "see with `strata doctor` whether it is published again and again");
  }
  ReflectionGrid map = convert::from_message(*message);
  if (format.mode == log::MapMode::kTrinary) make_trinary(map, free, occupied);
  format.free = as_meant(free);
  format.occupied = as_meant(occupied);
  fs::path file = fs::path(config_.folder) / request.map_url();  // as it is when absolute
  if (file.extension() != ".yaml") file += ".yaml";
  log::write_map(file, map, format);
}

}  // namespace strata::map_saver
