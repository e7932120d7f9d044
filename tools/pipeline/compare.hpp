// SPDX-License-Identifier: Apache-2.0
/// Learns on a part of a log, localizes on the rest with every map: docs/theory/evaluation.md.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "components/maps/map_models.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/base/progress.hpp"
#include "tools/pipeline/compare_config.hpp"
#include "tools/pipeline/comparison.hpp"
#include "tools/pipeline/learn.hpp"
#include "tools/pipeline/localize.hpp"
#include "tools/pipeline/runs_input.hpp"
#include "tools/pipeline/split.hpp"
#include "tools/pipeline/test_part.hpp"

namespace strata::pipeline {

/// A comparison with what pictures need; learned, maps and drive are of the first split.
struct CompareOutcome {
  Comparison comparison;
  LearnResult learned;
  maps::Maps maps;
  TestPart drive;  ///< the first one
};

/// One run of the localizer with one model and one seed.
struct LocalizeJob {
  std::span<const Observation> observations;
  std::span<const std::optional<Pose2>> truths;  ///< map_from_robot where known
  const maps::MapModel& model;
  const ReflectionGrid& free_space;
  const localization::LocalizerConfig& config;
  Pose2Gaussian start;
  std::uint64_t seed = 1;
};
using LocalizeFunction = std::function<LocalizationRun(const LocalizeJob&)>;
/// Given the maps of a split: who localizes in them. Called from one thread; what it returns, from
/// several.
using MakeLocalize = std::function<LocalizeFunction(const LearnResult&, const CompareConfig&)>;

/// Somebody else's localizer, in the occupancy map of each split; its LocalizeJob names the model
/// `occupancy`.
struct Peer {
  std::string name;  ///< as a model: "peer_mrpt"
  std::function<LocalizationRun(const LocalizeJob&, const ReflectionGrid& map)> localize;
};

/// What is done of one split, when others do the rest.
struct SplitShare {
  /// Some of the job's seeds, in their order; none: the split is not even learned.
  std::vector<std::uint64_t> seeds;
  /// Everything but runs of the localizer at full memory, too. That asks for the first seeds
  /// (seeds_for_scores).
  bool with_scores = true;
};

/// What a comparison is made of, besides the runs.
struct CompareJob {
  std::string log;  ///< for people
  std::vector<Split> splits;
  std::vector<std::uint64_t> seeds;
  /// A map for the model `map`, in the frame of the truth, or of the poses when there is no truth.
  ReflectionGrid given_map;
  /// What the models of the configuration are looked up in.
  const maps::MapModels* map_models = &maps::map_models();
  int threads = 1;  ///< for learning
  int jobs = 0;     ///< runs of the localizer at once; 0: as threads. Results do not depend on it
  Progress* progress = nullptr;
  MakeLocalize localize_with;      ///< empty: the library itself, in this process
  std::string via = "direct";      ///< what to call that way in the report
  std::vector<Peer> peers;         ///< localize beside our models; they predict no scans
  std::vector<SplitShare> shares;  ///< one a split; empty: all of each
};

/// A comparison, split by split.
struct SplitOutcomes {
  std::vector<Comparison> splits;  ///< one a split; without parts where nothing was to be done
  LearnResult learned;             ///< of the first split, when that was learned
  maps::Maps maps;
  TestPart drive;  ///< its first one
};

/// Learns on the first part of each split and localizes in each run of the second with every model
/// and seed. Errors are measured against, in this order: given truths (in the map frame by one
/// rigid alignment over the learning part), given poses, or the trajectory that SLAM gives to the
/// whole log at once, which is labelled as such. With several splits learning takes the poses
/// given, else those of SLAM over everything. Throws InputError when a part is empty,
/// and ConfigError for a model that there is not.
[[nodiscard]] CompareOutcome compare(const Runs& runs, const CompareConfig& config,
                                     const CompareJob& job);

/// The same, as far as the job's shares go; the splits are then to be merged with those of others
/// (join_comparisons.hpp).
[[nodiscard]] SplitOutcomes compare_splits(const Runs& runs, const CompareConfig& config,
                                           const CompareJob& job);

/// Of this many first seeds the runs are looked at when a split is scored.
[[nodiscard]] std::size_t seeds_for_scores(const CompareConfig& config, std::size_t seeds);

}  // namespace strata::pipeline
