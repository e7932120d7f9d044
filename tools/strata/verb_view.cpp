// SPDX-License-Identifier: Apache-2.0
/// `strata view MAPS`: shows a folder of maps in the browser, until Ctrl-C.
#include <string>

#include "components/bus/endpoint.hpp"
#include "components/convert/map_messages.hpp"
#include "components/convert/patch_messages.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/base/error.hpp"
#include "tools/strata/composition_options.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"
#include "tools/strata/view_host.hpp"

namespace strata::tools {
namespace {

constexpr const char* kMapFrame = "map";

struct FolderViewOptions {
  std::string maps;
  int port = kViewPort;
};

/// The maps of a folder as latched topics that only this process hears.
class MapTopics {
 public:
  MapTopics(const std::shared_ptr<bus::Participant>& participant, const maps::Maps& maps)
      : map_(participant, std::string("/map"), bus::qos_profile("latched")),
        filtered_(participant, std::string("/map_filtered"), bus::qos_profile("latched")),
        patches_(participant, std::string("/patch_map"), bus::qos_profile("latched")) {
    if (!maps.occupancy.rect().empty()) {
      map_.publish(convert::to_occupancy(maps.occupancy, Stamp{}, kMapFrame));
    }
    if (!maps.filtered.rect().empty()) {
      filtered_.publish(convert::to_occupancy(maps.filtered, Stamp{}, kMapFrame));
    }
    if (maps.patches) patches_.publish(convert::to_message(*maps.patches, Stamp{}, kMapFrame));
  }

 private:
  bus::Writer<nav_msgs::msg::OccupancyGrid> map_;
  bus::Writer<nav_msgs::msg::OccupancyGrid> filtered_;
  bus::Writer<strata_msgs::msg::PatchMap> patches_;
};

void view(const FolderViewOptions& options, VerbContext& context) {
  const YAML::Node parameters = load_config(context.options);
  const maps::Maps maps = maps::read_maps(options.maps);
  runtime::Composition alone;
  alone.place = "strata view";
  alone.network.transport = bus::Transport::kLoopback;
  alone.network.is_alone = true;
  const auto participant = join(alone, context);
  const MapTopics topics(participant, maps);
  const ViewHost host(alone, participant,
                      {.port = options.port, .parameters = parameters, .allow_commands = false},
                      context);
  context.note("shows " + options.maps + "; Ctrl-C ends it");
  while (!context.interrupt().wait_for(0.1)) {
  }
}

}  // namespace

void add_view(CLI::App& app, VerbContext& context) {
  const auto [verb, options] = add_verb<FolderViewOptions>(
      app, context, "view", "show a folder of maps in the browser", "strata view maps", view);
  verb->add_option("MAPS", options->maps, "folder that `strata learn` wrote, or a robot keeps")
      ->required();
  verb->add_option("--port", options->port, "of http://localhost:PORT/")
      ->check(CLI::Range(1, 65535))
      ->capture_default_str();
}

}  // namespace strata::tools
