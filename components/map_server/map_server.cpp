// SPDX-License-Identifier: Apache-2.0
#include "components/map_server/map_server.hpp"

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "components/convert/map_messages.hpp"
#include "components/log/map_file.hpp"
#include "core/base/error.hpp"

namespace strata::map_server {
namespace {

/// Results of nav2_msgs/srv/LoadMap.
enum LoadResult : std::uint8_t { kSuccess = 0, kNoSuchMap = 1, kInvalidMap = 2, kFailure = 255 };

/// "/maps/a.yaml" of "file:///maps/a.yaml" and of itself.
std::filesystem::path path_of(const std::string& url) {
  constexpr std::string_view kScheme = "file://";
  return url.starts_with(kScheme) ? url.substr(kScheme.size()) : url;
}

}  // namespace

void MapServer::on_configure() {
  config_ = read_parameters<MapServerConfig>();
  map_.reset();
  if (!config_.map.empty()) map_ = log::read_map(config_.map);
  loaded_ = now();
  publish_ = advertise<nav_msgs::msg::OccupancyGrid>(config_.topic, "latched");
  offer<bus::srv::GetMap>("~/map", [this](const auto&) {
    nav_msgs::srv::GetMap_Response response;
    if (map_) response.grid(message());
    return response;
  });
  offer<bus::srv::LoadMap>("~/load_map",
                           [this](const auto& request) { return load(request.map_url()); });
}

void MapServer::on_activate() {
  if (map_) publish_(message());
}

nav_msgs::msg::OccupancyGrid MapServer::message() const {
  return convert::to_occupancy(*map_, loaded_, config_.map_frame);
}

nav2_msgs::srv::LoadMap_Response MapServer::load(const std::string& url) {
  nav2_msgs::srv::LoadMap_Response response;
  response.result(kFailure);
  if (state() != runtime::LifecycleState::kActive) return response;
  const std::filesystem::path path = path_of(url);
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    response.result(kNoSuchMap);
    return response;
  }
  try {
    map_ = log::read_map(path);
  } catch (const InputError& reason) {  // the map as it was stays; the client gets a number only
    tell(reason);
    response.result(kInvalidMap);
    return response;
  }
  loaded_ = now();
  response.result(kSuccess);
  response.grid(message());
  publish_(response.grid());
  return response;
}

}  // namespace strata::map_server
