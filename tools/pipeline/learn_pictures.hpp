// SPDX-License-Identifier: Apache-2.0
/// What learning did to the map, for people to look at.
#pragma once

#include <filesystem>

#include "core/beam_filter/config.hpp"
#include "core/patch/patch_map.hpp"
#include "core/slam/slam.hpp"
#include "tools/report/drawings.hpp"

namespace strata::pipeline {

/// What every MAPS folder shows.
inline constexpr const char* kMapPicture = "map.png";
inline constexpr const char* kDynamicPicture = "dynamic.png";

/// Writes into an existing folder map.png, the map of static beams with the way that was driven and
/// frames round the places that change, and dynamic.png, the map of all beams with those held to be
/// dynamic marked. Nothing when no cell is known.
void write_map_pictures(const std::filesystem::path& folder, const slam::SlamResult& result,
                        const patch::PatchMap& patches, report::Drawings& drawings);

/// Rounds of EM that `write_learn_pictures` shows.
inline constexpr int kShownRounds = 6;

/// Writes report.html into `folder`, which it creates, with: the map of all beams, those judged
/// dynamic marked, against the filtered one (figures 1.4 to 1.6 of [stachniss2003chapter]); the log
/// likelihood of the data round by round (figure 1.8); and the map after each of the first rounds
/// of EM at the poses found (figure 1.7), also as map_server files round_N.yaml. The map of round 0
/// is that of all beams. Each cell is judged by itself there, as in the paper. A result without
/// scans gives a page that says so. Throws OutputError.
void write_learn_pictures(const std::filesystem::path& folder, const slam::SlamResult& result,
                          const beam_filter::BeamFilterConfig& config);

}  // namespace strata::pipeline
