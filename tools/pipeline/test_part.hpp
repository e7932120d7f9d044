// SPDX-License-Identifier: Apache-2.0
/// A drive to localize in, and what changed on its way since the maps were learned.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/geometry/pose2_gaussian.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/scan/scan.hpp"
#include "tools/pipeline/changes.hpp"
#include "tools/pipeline/compare_config.hpp"
#include "tools/pipeline/comparison.hpp"
#include "tools/pipeline/split.hpp"

namespace strata::pipeline {

/// One drive to localize in: the same for every model.
struct TestPart {
  TestPartInfo info;
  std::vector<Observation> observations;
  std::vector<std::optional<Pose2>> truths;
  Pose2Gaussian start;
  Changes changes;
};

/// The runs of the test part, each from its first scan with a known pose on; runs without any are
/// left out. elapsed: of each observation; truths: map_from_robot where known. Throws
/// InputError when nothing is left.
[[nodiscard]] std::vector<TestPart> make_test_parts(const Runs& runs, const Split& split,
                                                    const std::vector<double>& elapsed,
                                                    const std::vector<std::optional<Pose2>>& truths,
                                                    const CompareProtocol& protocol);

/// Finds what changed since the scans that were learned from, and counts who sees it.
void look_for_changes(std::span<const PosedScan> learned, const ReflectionGrid& map,
                      const CompareConfig& config, TestPart& part);

/// The errors where it changed; run.errors has an entry for each scan with a known pose.
void judge_changed_places(const TestPart& part, ModelRun& run);

}  // namespace strata::pipeline
