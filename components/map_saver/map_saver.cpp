// SPDX-License-Identifier: Apache-2.0
#include "components/map_saver/map_saver.hpp"

#include <chrono>
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

float threshold_or(float asked, float standard) { return asked == 0.0F ? standard : asked; }

}  // namespace

void MapSaver::on_configure() {
  config_ = read_parameters<MapSaverConfig>();
  keep_live(config_, {"folder", "topic", "save_map_timeout_s"});
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
  const bus::Reader<nav_msgs::msg::OccupancyGrid> reader(
      context().participant, topic, bus::qos_profile("latched"), [&](const auto& message) {
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
  if (!request.image_format().empty() && request.image_format() != "pgm") {
    throw InputError(place, "image_format is '" + request.image_format() + "'", "ask for pgm");
  }
  if (!request.map_mode().empty() && request.map_mode() != "trinary") {
    throw InputError(place, "map_mode is '" + request.map_mode() + "'", "ask for trinary");
  }
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
                     "see with `strata doctor` whether it is published, latched");
  }
  ReflectionGrid map = convert::from_message(*message);
  make_trinary(map, free, occupied);
  fs::path file = fs::path(config_.folder) / request.map_url();  // as it is when absolute
  if (file.extension() != ".yaml") file += ".yaml";
  log::write_map(file, map);
}

}  // namespace strata::map_saver
