// SPDX-License-Identifier: Apache-2.0
#include "components/map_saver/nav2_parameters.hpp"

namespace strata::map_saver {

runtime::StandIn nav2_stand_in() {
  return {"map_saver",
          "strata::MapSaver",
          {"save_map_timeout", "free_thresh_default", "occupied_thresh_default",
           "map_subscribe_transient_local", "bond_heartbeat_period", "introspection_mode",
           "service_introspection_mode"},
          [](runtime::Translator& t) {
            t.map_as_it_is<double>("save_map_timeout", "save_map_timeout_s");
            for (const char* name : {"free_thresh_default", "occupied_thresh_default"}) {
              t.ignore(name, "a request without thresholds means 0.25 and 0.65");
            }
            t.map_as_it_is<bool>("map_subscribe_transient_local", "map_subscribe_transient_local");
            t.ignore("bond_heartbeat_period", "the bond has its own period");
            for (const char* name : {"introspection_mode", "service_introspection_mode"}) {
              t.ignore(name, "services are not recorded");
            }
          }};
}

}  // namespace strata::map_saver
