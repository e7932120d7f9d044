// SPDX-License-Identifier: Apache-2.0
/// Maps of one split of the logs, and the truth in their frame.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "components/maps/maps_folder.hpp"
#include "core/base/progress.hpp"
#include "core/scan/scan.hpp"
#include "tools/pipeline/compare.hpp"
#include "tools/pipeline/learn.hpp"
#include "tools/pipeline/runs_input.hpp"
#include "tools/pipeline/split.hpp"

namespace strata::pipeline {

using Poses = std::vector<std::optional<Pose2>>;

[[nodiscard]] bool any_known(const Poses& poses);

/// Poses of a SLAM result, one an observation; nothing for scans that it skipped.
[[nodiscard]] Poses poses_of(const slam::SlamResult& result,
                             std::span<const Observation> observations);

/// The trajectory that SLAM gives to the whole log at once, one entry an observation.
[[nodiscard]] Poses joint_trajectory(const Runs& runs, const CompareConfig& config, int threads,
                                     Progress* progress);

/// What was learned, ready to localize in; `decoding` as memory::decode.
[[nodiscard]] maps::Maps maps_of(const LearnResult& result, const memory::DecodingConfig& decoding,
                                 const maps::TimescaleUseConfig& use = {});

/// When a model that is compared needs them; places known already are kept.
void add_place_patches(const CompareConfig& config, const CompareJob& job, LearnResult& result);

struct Learned {
  LearnResult result;
  maps::Maps maps;
  Poses truths;  ///< map_from_robot, one an observation of the runs
};

/// Learns every map from the first part of a split. poses: one an observation of the runs, or
/// empty for those that SLAM finds. Throws InputError when a given truth has no pose in that part.
[[nodiscard]] Learned learn_split(const Runs& runs, const Split& split, const Poses& poses,
                                  const CompareConfig& config, const CompareJob& job);

}  // namespace strata::pipeline
