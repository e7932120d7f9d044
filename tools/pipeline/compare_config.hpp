// SPDX-License-Identifier: Apache-2.0
/// Settings of a comparison.
#pragma once

#include <string>
#include <vector>

#include "components/log/log_config.hpp"
#include "components/maps/learn_config.hpp"
#include "components/maps/map_models.hpp"
#include "components/maps/timescale_use.hpp"
#include "core/localization/localizer_config.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "core/topology/mapper_config.hpp"
#include "memory/decoding/decoding_config.hpp"

namespace strata::pipeline {

/// How runs begin, and what is compared.
struct CompareProtocol {
  std::vector<std::string> models = maps::map_models().compared();
  double train_share = 0.6;
  double start_stddev_m = 0.1;
  double start_stddev_rad = 0.05;
  int prediction_every = 5;
  int memory_steps = 2;
  int memory_seeds = 5;
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
    v.field(
        "memory_steps", c.memory_steps,
        {.doc = "every model is learned again in less memory (grids: a quarter of the bytes), this "
                "many times; 0: not at all",
         .min = 0,
         .max = 4});
    v.field("memory_seeds", c.memory_seeds,
            {.doc = "... and localized in with the first seeds, this many runs over all drives "
                    "together, at least one a drive",
             .min = 1});
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
  memory::DecodingConfig decoding;
  maps::TimescaleUseConfig timescale_use;
  localization::LocalizerConfig localizer;
  patch_beams::PatchBeamModelConfig sensor;
  topology::TopologyMapperConfig topology;
  log::LogConfig log;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("protocol", c.protocol, "what is compared, and how");
    v.group("learn", c.learn, "how the maps are learned");
    v.group("decoding", c.decoding, "how levels of the timescale memory become expected scans");
    v.group("timescale_use", c.timescale_use, "how the timescale memory is used");
    v.group("localizer", c.localizer, "the particle filter, the same for every model");
    v.group("sensor", c.sensor, "the beam model, the same for every model");
    v.group("topology", c.topology,
            "how the places are found that the sub-maps of patch_places follow, at the poses that "
            "all maps are learned at");
    v.group("log", c.log, "what logs do not say of themselves");
  }
};

}  // namespace strata::pipeline
