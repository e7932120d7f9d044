// SPDX-License-Identifier: Apache-2.0
/// How far the scans of a map made of a real log are from the true poses that came with it.
#pragma once

#include <span>
#include <vector>

#include "components/log/trajectory_file.hpp"
#include "core/scan/scan.hpp"
#include "tools/pipeline/runs_input.hpp"

namespace strata::paper {

/// The true poses of the observations that have one, in the order and the frame of the truth.
[[nodiscard]] std::vector<log::StampedPose> stamped_truth(const pipeline::Runs& runs);

/// Mean distance of the scans' poses from the true ones at the same moment [m], after one rigid
/// alignment. truth: sorted by stamp, in any frame.
[[nodiscard]] double pose_error_m(std::span<const PosedScan> scans,
                                  std::span<const log::StampedPose> truth);

}  // namespace strata::paper
