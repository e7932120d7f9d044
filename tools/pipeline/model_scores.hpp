// SPDX-License-Identifier: Apache-2.0
/// What is asked of each model beside localizing: predicting, adapting, planning.
#pragma once

#include <cstddef>
#include <vector>

#include "components/maps/map_model.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/base/parallel.hpp"
#include "tools/pipeline/compare_config.hpp"
#include "tools/pipeline/comparison.hpp"
#include "tools/pipeline/test_part.hpp"

namespace strata::pipeline {

/// Own poses of this many seeds are predicted from: one alone may be lost by bad luck.
inline constexpr std::size_t kOwnPoseSeeds = 3;

/// Adds to each result (the first ones of `results`, one a model, whose runs in this part are there
/// already) its scores in this part. models: made of maps. Deterministic but for times, at any
/// number of threads.
void score_models(const std::vector<maps::MapModel>& models, const TestPart& part,
                  std::size_t part_index, const maps::Maps& maps, const CompareConfig& config,
                  WorkerPool& pool, std::vector<ModelResult>& results);

}  // namespace strata::pipeline
