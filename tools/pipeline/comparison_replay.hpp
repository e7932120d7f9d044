// SPDX-License-Identifier: Apache-2.0
/// The first drive of a comparison, every model's first run side by side.
#pragma once

#include <filesystem>

#include "components/maps/maps_folder.hpp"
#include "tools/pipeline/comparison.hpp"
#include "tools/pipeline/test_part.hpp"

namespace strata::pipeline {

/// Writes replay.html into an existing folder, in the map of static beams. maps: of the first
/// split; drive: its first part. A model whose first run has not a pose for each scan is left out.
/// Throws OutputError.
void write_comparison_replay(const Comparison& comparison, const maps::Maps& maps,
                             const TestPart& drive, const std::filesystem::path& folder);

}  // namespace strata::pipeline
