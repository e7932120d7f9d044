// SPDX-License-Identifier: Apache-2.0
#include "components/map_server/map_server.hpp"

#include "components/convert/map_messages.hpp"
#include "components/log/map_file.hpp"

namespace strata::map_server {

void MapServer::on_configure() {
  config_ = read_parameters<MapServerConfig>();
  map_ = log::read_map(config_.map);
  publish_ = advertise<nav_msgs::msg::OccupancyGrid>(config_.topic, "latched");
}

void MapServer::on_activate() { publish_(convert::to_occupancy(map_, Stamp(), config_.map_frame)); }

}  // namespace strata::map_server
