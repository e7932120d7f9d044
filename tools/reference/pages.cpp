// SPDX-License-Identifier: Apache-2.0
#include "tools/reference/pages.hpp"

#include <fstream>
#include <sstream>

#include "components/beam_filter/config.hpp"
#include "components/fleet_member/config.hpp"
#include "components/incident_recorder/config.hpp"
#include "components/live_view/config.hpp"
#include "components/localizer/config.hpp"
#include "components/log/log_config.hpp"
#include "components/map_saver/config.hpp"
#include "components/map_server/config.hpp"
#include "components/patch_learner/config.hpp"
#include "components/player/config.hpp"
#include "components/recorder/config.hpp"
#include "components/scan_matcher/config.hpp"
#include "components/settings/reference_page.hpp"
#include "components/timescale_memory/config.hpp"
#include "components/topology_mapper/config.hpp"
#include "components/volume_mapper/config.hpp"
#include "core/base/error.hpp"
#include "core/patch/patch_learner.hpp"
#include "core/scan/history.hpp"
#include "core/slam/slam.hpp"
#include "core/topology/mapper_config.hpp"
#include "memory/nodes/timescale_config.hpp"
#include "tools/reference/map_models_page.hpp"
#include "tools/reference/metrics_page.hpp"
#include "tools/simulate/scenario.hpp"
#include "tools/site/gate.hpp"

namespace strata::reference {
namespace {

template <typename Config>
Page page(const std::string& file, const std::string& title, const std::string& about) {
  return {file,
          "# " + title + "\n\n" + about +
              "\n\nMade by `strata-reference` from the code; do not edit. Keys of groups are "
              "joined by dots, as `--set` takes them; `[]` stands for each item of a "
              "list.\n\n" +
              settings::reference_markdown<Config>(),
          settings::reference_rows<Config>(), settings::preset_lines(settings::key_tree<Config>())};
}

/// The parameters of strata::TYPE, as a composition gives them.
template <typename Config>
Page component_page(const std::string& room, const std::string& type) {
  return page<Config>("component_" + room + ".md", "Parameters of strata::" + type,
                      "What stands below `parameters:` of the component in a composition "
                      "(`components/" +
                          room + "`); on the command line `--set NAME.parameter=value`.");
}

}  // namespace

std::vector<Page> make_pages() {
  return {
      component_page<scan_matcher::ScanMatcherConfig>("scan_matcher", "ScanMatcher"),
      component_page<beam_filter::BeamFilterComponentConfig>("beam_filter", "BeamFilter"),
      component_page<patch_learner::PatchLearnerComponentConfig>("patch_learner", "PatchLearner"),
      component_page<localizer::LocalizerComponentConfig>("localizer", "Localizer"),
      component_page<timescale_memory::TimescaleMemoryConfig>("timescale_memory",
                                                              "TimescaleMemory"),
      component_page<map_server::MapServerConfig>("map_server", "MapServer"),
      component_page<map_saver::MapSaverConfig>("map_saver", "MapSaver"),
      component_page<topology_mapper::TopologyMapperComponentConfig>("topology_mapper",
                                                                     "TopologyMapper"),
      component_page<volume_mapper::VolumeMapperConfig>("volume_mapper", "VolumeMapper"),
      component_page<player::PlayerConfig>("player", "Player"),
      component_page<recorder::RecorderConfig>("recorder", "Recorder"),
      component_page<incident_recorder::IncidentRecorderConfig>("incident_recorder",
                                                                "IncidentRecorder"),
      component_page<fleet_member::FleetMemberConfig>("fleet_member", "FleetMember"),
      component_page<live_view::LiveViewConfig>("live_view", "LiveView"),
      page<log::LogConfig>("log.md", "Settings of reading logs",
                           "What stands below `log:` in what `strata learn`, `localize` and "
                           "`compare` read with `--config` (`components/log`)."),
      page<slam::SlamConfig>("slam.md", "Settings of mapping",
                             "How scans become poses, beam labels and maps (`core/slam`)."),
      page<patch::PatchLearnerConfig>(
          "patch_learner.md", "Settings of patch learning",
          "How sub-maps and their configurations are found (`core/patch`)."),
      page<memory::TimescaleConfig>("timescale.md", "Settings of the timescale memory",
                                    "Nodes, levels and how fast they forget (`memory/nodes`)."),
      page<HistoryConfig>("history.md", "Settings of what is kept of earlier runs",
                          "What stands below `history:` for `strata learn --update`, `site merge` "
                          "and `fleet learn` (`core/scan`)."),
      page<topology::TopologyMapperConfig>(
          "topology.md", "Settings of topological mapping",
          "What `strata topology --config FILE` reads (`core/topology`)."),
      page<simulate::ScenarioConfig>("scenario.md", "Scenario files",
                                     "What `strata simulate SCENARIO.yaml` reads; a file begins "
                                     "with `version: 1`. Examples lie "
                                     "in `tools/simulate/scenarios`."),
      page<site::GateLimits>(
          "site_gate.md", "Limits of a site's gate",
          "What `strata site check` and `approve` read with `--config` and "
          "`--set` (`tools/site`); `localizer.*` below them are the localizer's."),
      {"map_models.md", map_models_page(maps::map_models()), {}, {}},
      {"metrics.md", metrics_page(), {}, {}},
  };
}

void write_pages(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (const Page& page : make_pages()) {
    std::ofstream out(folder / page.file, std::ios::binary);
    out << page.text;
    out.close();
    if (!out) {
      throw OutputError((folder / page.file).string(), "cannot be written",
                        "check the folder and the free space");
    }
  }
}

std::vector<std::string> outdated_pages(const std::filesystem::path& folder) {
  std::vector<std::string> outdated;
  for (const Page& page : make_pages()) {
    std::ifstream in(folder / page.file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in || text.str() != page.text) outdated.push_back(page.file);
  }
  return outdated;
}

}  // namespace strata::reference
