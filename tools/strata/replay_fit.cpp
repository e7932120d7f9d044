// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/replay_fit.hpp"

#include <fstream>
#include <optional>

#include <nlohmann/json.hpp>

#include "components/bus/names.hpp"
#include "components/log/trajectory_file.hpp"
#include "components/maps/localization_files.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/runtime/host.hpp"
#include "tools/strata/fit_warning.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

std::string text_of(const YAML::Node& parameters, const char* key) {
  return parameters[key].IsDefined() ? parameters[key].as<std::string>() : "";
}

/// None where they explain it, or it never localized.
std::vector<std::string> warnings_of(const fs::path& folder, const runtime::ComponentEntry& entry,
                                     const pipeline::Runs& runs) {
  std::ifstream in(folder / maps::kMetricsFile);
  if (!in) return {};
  const auto metrics = nlohmann::json::parse(in);
  const std::string maps_folder = text_of(entry.parameters, "maps");
  pipeline::LogFit fit;
  if (!maps_folder.empty() && metrics["scans"].get<std::size_t>() > 0) {
    fit = pipeline::fit_of_trajectory(maps::read_maps(maps_folder).filtered, runs.observations,
                                      log::read_trajectory(folder / maps::kTrajectoryFile));
  }
  LocalizedLog log{fit, std::nullopt, metrics["model"].get<std::string>(), ""};
  const nlohmann::json& score = metrics["score"]["place_mean"];
  if (!score.is_null()) log.mean_score = score.get<double>();
  const YAML::Node start = entry.parameters["start"];
  const bool has_start = start.IsDefined() && start.IsMap() && start["pose"].IsDefined();
  if (has_start && start["pose"].size() > 0) log.begin = "start.pose";
  std::vector<std::string> warnings{start_warning(metrics["relocations"], log.begin),
                                    fit_warning(log)};
  std::erase(warnings, "");
  return warnings;
}

}  // namespace

std::vector<std::string> fit_warnings(const fs::path& out, const runtime::Composition& composition,
                                      const pipeline::Runs& runs) {
  std::vector<std::string> warnings;
  for (const runtime::ProcessEntry& process : composition.processes) {
    for (const runtime::ComponentEntry& entry : process.components) {
      if (entry.type != "strata::Localizer") continue;
      const fs::path folder = out / runtime::out_folder_of(entry, composition) /
                              text_of(entry.parameters, "out_subfolder");
      for (const std::string& warning : warnings_of(folder, entry, runs)) {
        warnings.push_back(warning + " (" +
                           bus::expand_name(entry.name, entry.node_namespace, entry.name) + ")");
      }
    }
  }
  return warnings;
}

}  // namespace strata::tools
