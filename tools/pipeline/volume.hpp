// SPDX-License-Identifier: Apache-2.0
/// From a 3-D log to a static 3-D map.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "components/log/cloud_reader.hpp"
#include "core/base/progress.hpp"
#include "core/volume/volume_map.hpp"
#include "core/volume/voxel_filter.hpp"
#include "tools/pipeline/cost.hpp"

namespace strata::pipeline {

/// Everything that can be set about 3-D maps.
struct VolumeJobConfig {
  volume::VolumeConfig map;
  volume::VoxelFilterConfig filter;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("map", c.map, "the octree");
    v.group("filter", c.filter, "what is taken for moving");
  }
};

struct VolumeResult {
  volume::VolumeMap map;
  log::CloudReport report;
  volume::CloudCounts counts;
  bool is_filtered = false;
  std::vector<Pose3> sensor_poses;
};

/// Reads the log once, or twice with the filter: the first time to learn what moves. Throws
/// InputError, ConfigError, Cancelled.
[[nodiscard]] VolumeResult make_volume(const std::filesystem::path& log,
                                       const VolumeJobConfig& config, bool filter, int threads,
                                       Progress* progress);

/// A height range [from, to) in metres.
struct SliceRange {
  double from_m = 0.0;
  double to_m = 0.0;
};

/// "0.2:0.5". Throws InputError.
[[nodiscard]] SliceRange parse_slice(const std::string& text);

/// Writes map.bt, map.ot, slice_N.yaml/.pgm, pictures, report.html and summary.json; returns the
/// summary. No slices: one of 0.4 m about the first sensor pose. Throws OutputError.
nlohmann::json write_volume(const std::filesystem::path& folder, const std::string& log,
                            const VolumeResult& result, std::vector<SliceRange> slices,
                            const Cost& cost);

}  // namespace strata::pipeline
