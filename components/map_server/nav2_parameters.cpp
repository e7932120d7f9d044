// SPDX-License-Identifier: Apache-2.0
#include "components/map_server/nav2_parameters.hpp"

#include <string>

namespace strata::map_server {

runtime::StandIn nav2_stand_in() {
  return {"map_server",
          "strata::MapServer",
          {"yaml_filename", "topic_name", "frame_id", "bond_heartbeat_period", "introspection_mode",
           "service_introspection_mode"},
          [](runtime::Translator& t) {
            // nav2's own file leaves it empty: a launch file fills it in, or ~/load_map names a
            // map.
            if (!t.read<std::string>("yaml_filename").value_or("").empty()) {
              t.map_as_it_is<std::string>("yaml_filename", "map");
            } else {
              t.ignore("yaml_filename", "it is empty");
            }
            t.map_as_it_is<std::string>("topic_name", "topic");
            t.map_as_it_is<std::string>("frame_id", "map_frame");
            t.ignore("bond_heartbeat_period", "the bond has its own period");
            for (const char* name : {"introspection_mode", "service_introspection_mode"}) {
              t.ignore(name, "services are not recorded");
            }
          }};
}

}  // namespace strata::map_server
