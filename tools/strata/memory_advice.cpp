// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/memory_advice.hpp"

#include <algorithm>
#include <array>

namespace strata::tools {
namespace {

struct Advice {
  std::string_view verb;
  std::string_view stage;  ///< empty: any other of the verb
  const char* text;
};

constexpr const char* kLessLog = "take a part of the log with --from and --to";
constexpr const char* kCoarserMaps =
    "make the maps' cells larger, --set slam.beam_filter.resolution_m=0.1, which needs a quarter "
    "of the default's memory, or take a part of the log with --from and --to";
constexpr const char* kFewerParticles =
    "take fewer particles, --set localizer.particles=N or, for a start from nowhere, --set "
    "localizer.global_start.max_particles=N";
constexpr const char* kLessLive = "let the process have fewer components, or more memory";
constexpr const char* kNoPatches =
    "leave the patches out, --only em,timescale, or make the maps' cells larger, --set "
    "slam.beam_filter.resolution_m=0.1";

// The first that fits.
constexpr std::array<Advice, 19> kAdvice{
    {{"learn", "read log", kLessLog},
     {"learn", "find sequences", kNoPatches},
     {"learn", "learn configurations", kNoPatches},
     {"learn", "remember scans", "leave the timescale memory out, --only em,patch"},
     {"learn", "", kCoarserMaps},
     {"localize", "read log", kLessLog},
     {"localize", "", kFewerParticles},
     {"compare", "localize",
      "work on fewer seeds at once, --jobs 1, or take fewer particles, "
      "--set localizer.particles=N"},
     {"compare", "read log", kLessLog},
     {"compare", "", kCoarserMaps},
     {"topology", "",
      "make the map's cells larger, --set resolution_m=0.1, or take a part of the "
      "log with --from and --to"},
     {"volume", "",
      "make the voxels larger, --resolution 0.2, which needs an eighth of the "
      "default's memory"},
     {"run", "", kLessLive},
     {"info", "", kLessLog},
     {"convert", "", kLessLog},
     {"record", "", "record fewer topics, --topics"},
     {"play", "", "convert the log into a bag, which is not read as a whole"},
     {"replay", "", kLessLog},
     {"simulate", "", "simulate fewer days or scans"}}};

/// Of a component: NAME stands for its name.
struct ComponentAdvice {
  std::string_view type;
  const char* text;
};

constexpr std::array<ComponentAdvice, 8> kComponentAdvice{
    {{"strata::ScanMatcher",
      "make its map's cells larger, --set NAME.slam.beam_filter.resolution_m=0.1, which needs a "
      "quarter of the default's memory, or let it keep fewer scans, --set "
      "NAME.live.window_scans=1000"},
     {"strata::BeamFilter", "make its map's cells larger, --set NAME.filter.resolution_m=0.1"},
     {"strata::PatchLearner", "let it keep less, --set NAME.online.learner.memory_mb=128"},
     {"strata::Localizer",
      "take fewer particles, --set NAME.localizer.particles=500 or, for a start from nowhere, "
      "--set NAME.localizer.global_start.max_particles=20000"},
     {"strata::TimescaleMemory",
      "place its nodes less densely, --set "
      "NAME.timescale.node_spacing_m=2"},
     {"strata::TopologyMapper", "let it keep fewer scans, --set NAME.keep.memory_mb=128"},
     {"strata::VolumeMapper", "make its voxels larger, --set NAME.map.resolution_m=0.2"},
     {"strata::IncidentRecorder", "let it keep less, --set NAME.memory_mb=64"}}};

}  // namespace

std::string memory_advice_of_component(std::string_view type, std::string_view name) {
  const auto* const found =
      std::find_if(kComponentAdvice.begin(), kComponentAdvice.end(),
                   [&](const ComponentAdvice& advice) { return advice.type == type; });
  if (found == kComponentAdvice.end()) return kLessLive;
  std::string text = found->text;
  constexpr std::string_view kName = "NAME";
  for (auto at = text.find(kName); at != std::string::npos; at = text.find(kName, at)) {
    text.replace(at, kName.size(), name);
    at += name.size();
  }
  return text + "; or give the process more memory";
}

std::string memory_advice(std::string_view verb, std::string_view stage) {
  const auto fits = [&](const Advice& advice) {
    return advice.verb == verb && (advice.stage.empty() || advice.stage == stage);
  };
  const auto found = std::find_if(kAdvice.begin(), kAdvice.end(), fits);
  return found == kAdvice.end() ? "" : found->text;
}

}  // namespace strata::tools
