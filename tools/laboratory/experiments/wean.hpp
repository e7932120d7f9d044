// SPDX-License-Identifier: Apache-2.0
/// The real experiment on patch maps: three runs through a building whose doors changed, each
/// localized in maps of the other two.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/patch/patch_map.hpp"
#include "core/slam/slam_config.hpp"
#include "tools/pipeline/learned_maps.hpp"
#include "tools/pipeline/runs_input.hpp"

namespace strata::experiments {

/// The three logs with their reference poses, and the poses that SLAM gives them together: a second
/// truth, whose walls coincide. The reference is good to 0.1 m across and 0.3 m along the corridor.
struct WeanRuns {
  pipeline::Runs runs;  ///< run ids from 0
  std::vector<PosedScan> scans;
  pipeline::Poses common;  ///< one an observation
};
/// How far references are believed [m] where walls that coincide matter, not the references, which
/// jump: for the common poses.
inline constexpr double kWeanCoherentStddev_m = 0.2;

/// Throws InputError.
[[nodiscard]] WeanRuns read_wean_runs(const std::filesystem::path& folder, int threads);

struct WeanMaps {
  maps::Maps maps;
  Pose2 map_from_common;  ///< a rigid alignment over the scans that were learned
};
/// The maps of some of the runs. refined: the reference poses are moved until walls coincide, those
/// of a single run too, as `strata learn --poses` moves those of several; else they stay. stddev_m:
/// how far they are believed.
[[nodiscard]] WeanMaps learn_wean_maps(const WeanRuns& wean, const std::vector<int>& of,
                                       bool refined, int threads,
                                       double stddev_m = slam::GivenPoseConfig{}.stddev_m);

/// What a patch map of two runs says of the doors, by their places in wean_doors().
struct WeanDoors {
  std::vector<std::size_t> changed;  ///< by the table: both runs saw them, each in another state
  std::vector<std::size_t> right;    ///< a sub-map has them in two states, as the runs have
  std::vector<std::vector<std::size_t>> of_submap;  ///< all doors that each sub-map covers
  std::size_t elsewhere = 0;                        ///< sub-maps that cover none
};
[[nodiscard]] WeanDoors judge_wean_doors(const patch::PatchMap& map, int run_a, int run_b);

struct WeanError {
  double mean_m = 0.0;
  double near_doors_m = 0.0;  ///< over the scans taken within 5 m of a door that changed
};
/// A run localized in one map, from the reference's first pose, with the settings of
/// `strata compare`. The error of a scan is that of all particles in the mean.
struct WeanOutcome {
  WeanError reference;
  WeanError common;
  double failure_rate = 0.0;  ///< share of scans further than 0.5 m from the reference
  bool is_lost = false;       ///< further than 1 m for 5 s or longer
  /// Scans of which the localizer's own verdict is that it is lost, taken ...
  std::size_t lost_scans = 0;  ///< within 2 m of a pose that was learned from
  std::size_t lost_beyond_scans =
      0;  ///< further from all: places that the map's runs did not visit
};
[[nodiscard]] WeanOutcome localize_wean_run(const WeanRuns& wean, int run, const WeanMaps& learned,
                                            const std::vector<int>& of, const std::string& model,
                                            std::uint64_t seed, int threads);

/// Prints, for each run held out, the sub-maps learned from the others, what they say of the doors,
/// and the means over the seeds of the outcomes in the patch map of both runs and in the filtered
/// map of either, refined and at the reference poses.
void report_wean(const std::filesystem::path& folder, std::uint64_t first_seed, int seeds);

}  // namespace strata::experiments
