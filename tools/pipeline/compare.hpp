// SPDX-License-Identifier: Apache-2.0
/// Learns on one part of a log and localizes on the rest with every map model (SPEC F).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "components/maps/learn_config.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/base/progress.hpp"
#include "core/localization/localizer_config.hpp"
#include "core/localization/patch_beam_model.hpp"
#include "tools/pipeline/comparison.hpp"
#include "tools/pipeline/learn.hpp"
#include "tools/pipeline/runs_input.hpp"

namespace strata::pipeline {

/// How runs begin, and what is compared.
struct CompareProtocol {
  std::vector<std::string> models = {"occupancy", "filtered", "patch", "timescale"};
  double train_share = 0.6;
  double start_stddev_m = 0.1;
  double start_stddev_rad = 0.05;
  int prediction_every = 5;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("models", c.models, {.doc = "map models to compare"});
    v.field("train_share", c.train_share,
            {.doc = "share of the time for learning; the rest is for localization",
             .unit = "1",
             .min = 0.05,
             .max = 0.95});
    v.field("start_stddev_m", c.start_stddev_m,
            {.doc = "spread of the particles about the true start", .unit = "m", .min = 0.0});
    v.field("start_stddev_rad", c.start_stddev_rad,
            {.doc = "... and in heading", .unit = "rad", .min = 0.0});
    v.field("prediction_every", c.prediction_every,
            {.doc = "every so many test scans are predicted", .unit = "scans", .min = 1});
    v.require(!c.models.empty(), "models", "is empty", "name at least one model");
  }
};

/// Learning for a comparison: given poses are the truth that errors are measured against, so they
/// are kept as they are.
[[nodiscard]] inline maps::LearnConfig learn_at_given_poses() {
  maps::LearnConfig config;
  config.slam.given_poses.refine = false;
  return config;
}

/// The same localizer, motion, noise, beams, particles, seeds and starts for every model.
struct CompareConfig {
  CompareProtocol protocol;
  maps::LearnConfig learn = learn_at_given_poses();
  localization::LocalizerConfig localizer;
  localization::PatchBeamModelConfig sensor;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("protocol", c.protocol, "what is compared, and how");
    v.group("learn", c.learn, "how the maps are learned");
    v.group("localizer", c.localizer, "the particle filter, the same for every model");
    v.group("sensor", c.sensor, "the beam model, the same for every model");
  }
};

/// Which observations belong to learning, and which to localization in what was learned.
struct Split {
  std::string name;
  std::vector<std::size_t> train;  ///< places in Runs::observations, in order
  std::vector<std::size_t> test;
};

/// The first `train_until_s` seconds are for learning; all logs count as one.
[[nodiscard]] Split split_by_time(const Runs& runs, const std::string& log, double train_until_s);
/// The first `train_runs` runs are for learning.
[[nodiscard]] Split split_by_run(const Runs& runs, const std::vector<std::string>& logs,
                                 int train_runs);
/// k splits: each fold is localized in maps of all others. Several logs: fold i is every k-th of
/// them, from i on; one log: the i-th of k equal pieces of its time. Throws InputError when there
/// are fewer logs, or scans, than folds, or k < 2.
[[nodiscard]] std::vector<Split> make_folds(const Runs& runs, const std::vector<std::string>& logs,
                                            int k);

/// A comparison with what pictures need; learned and maps are of the first split.
struct CompareOutcome {
  Comparison comparison;
  LearnResult learned;
  maps::Maps maps;
};

/// What a comparison is made of, besides the runs.
struct CompareJob {
  std::string log;  ///< for people
  std::vector<Split> splits;
  std::vector<std::uint64_t> seeds;
  /// A map for the model `map`, in the frame of the truth, or of the poses when there is no truth.
  ReflectionGrid given_map;
  int threads = 1;  ///< for learning
  int jobs = 0;     ///< runs of the localizer at once; 0: as threads. Results do not depend on it
  Progress* progress = nullptr;
};

/// Learns on the first part of each split and localizes in each run of the second with every model
/// and seed. Errors are measured against, in this order: given truths (in the map frame by one
/// rigid alignment over the learning part), given poses, or the trajectory that SLAM gives to the
/// whole log at once, which is labelled as such. With several splits learning takes the poses
/// given, else those of SLAM over everything. Throws InputError when a part is empty.
[[nodiscard]] CompareOutcome compare(const Runs& runs, const CompareConfig& config,
                                     const CompareJob& job);

}  // namespace strata::pipeline
