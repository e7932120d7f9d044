// SPDX-License-Identifier: Apache-2.0
/// A 3-D map as files, pictures and numbers.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/pipeline/cost.hpp"
#include "tools/pipeline/volume.hpp"
#include "tools/report/drawings.hpp"

namespace strata::pipeline {

/// A height range [from, to) in metres.
struct SliceRange {
  double from_m = 0.0;
  double to_m = 0.0;
};

/// "0.2:0.5". Throws InputError.
[[nodiscard]] SliceRange parse_slice(const std::string& text);

/// Writes map.bt, map.ot, map_color.ot (by images, else by height), textured.glb where there are
/// textures, slice_N.yaml/.pgm, pictures, report.html, summary.json and, with a memory,
/// changes.json; returns the summary. No slices: one of 0.4 m about the first sensor pose.
/// drawings: told of pictures that cannot be drawn. Throws OutputError.
nlohmann::json write_volume(const std::filesystem::path& folder, const std::string& log,
                            const VolumeResult& result, std::vector<SliceRange> slices,
                            const Cost& cost, report::Drawings& drawings);

}  // namespace strata::pipeline
