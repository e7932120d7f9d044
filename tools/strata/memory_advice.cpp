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
constexpr const char* kLessLive =
    "give a scan matcher or beam filter larger cells (resolution_m), a localizer fewer particles "
    "(particles, global_start.max_particles), a patch learner less to keep "
    "(online.learner.memory_mb), or the process more memory";
constexpr const char* kNoPatches =
    "leave the patches out, --only em,timescale, or make the maps' cells larger, --set "
    "slam.beam_filter.resolution_m=0.1";

// The first that fits.
constexpr std::array<Advice, 16> kAdvice{
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
     {"replay", "", kLessLog},
     {"simulate", "", "simulate fewer days or scans"}}};

}  // namespace

std::string memory_advice(std::string_view verb, std::string_view stage) {
  const auto fits = [&](const Advice& advice) {
    return advice.verb == verb && (advice.stage.empty() || advice.stage == stage);
  };
  const auto found = std::find_if(kAdvice.begin(), kAdvice.end(), fits);
  return found == kAdvice.end() ? "" : found->text;
}

}  // namespace strata::tools
