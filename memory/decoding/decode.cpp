// SPDX-License-Identifier: Apache-2.0
#include "memory/decoding/decode.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

#include "memory/decoding/graph.hpp"
#include "memory/decoding/row_counts.hpp"

namespace strata::memory {
namespace {

constexpr float kUnknownRange = std::numeric_limits<float>::quiet_NaN();

/// Reorders `values`; NaN for none.
float lower_median(std::vector<float>& values) {
  if (values.empty()) return kUnknownRange;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The range bin with most samples, the nearest of equals.
std::uint8_t most_frequent(const NodeLevel& level, int angle_bin, detail::RowCounts& row) {
  row.fill(level, angle_bin);
  return *std::max_element(
      row.states.begin(), row.states.end(),
      [&](std::uint8_t a, std::uint8_t b) { return row.count[a] < row.count[b]; });
}

float median_in_range_bin(const NodeLevel& level, int angle_bin, std::uint8_t range_bin,
                          std::vector<float>& scratch) {
  scratch.clear();
  for (const float range_m : level.samples(angle_bin)) {
    if (level.bins().state_bin(range_m) == range_bin) scratch.push_back(range_m);
  }
  return lower_median(scratch);
}

/// Minus how far the way is free: of the samples without a range that reach beyond all that have
/// one. Requires one of those.
float free_end(const NodeLevel& level, int angle_bin, std::vector<float>& scratch) {
  int furthest = -1;
  for (const float range_m : level.samples(angle_bin)) {
    if (range_m >= 0.0F) furthest = std::max<int>(furthest, level.bins().range_bin(range_m));
  }
  scratch.clear();
  for (const float range_m : level.samples(angle_bin)) {
    if (range_m < 0.0F && level.bins().range_bin(-range_m) > furthest) scratch.push_back(-range_m);
  }
  return -lower_median(scratch);
}

}  // namespace

DecodedScan decode(const NodeLevel& level, const DecodingConfig& config) {
  const LayeredGraph graph = build_graph(level, config);
  const ClosedPath path =
      config.search == SearchMethod::kDijkstra ? search_dijkstra(graph) : search_layered(graph);
  DecodedScan result;
  result.cost = path.cost;
  result.inconsistent = !path.found;
  result.range_m.assign(graph.rows(), kUnknownRange);
  std::vector<float> scratch;
  detail::RowCounts counts;
  for (std::size_t row = 0; row < graph.rows(); ++row) {
    const int angle_bin = static_cast<int>(row);
    if (level.samples(angle_bin).empty()) continue;
    std::uint8_t range_bin =
        path.found ? graph.states(row)[path.states[row]] : LayeredGraph::kWildcard;
    if (range_bin == LayeredGraph::kWildcard) range_bin = most_frequent(level, angle_bin, counts);
    result.range_m[row] = range_bin == level.bins().beyond_bin()
                              ? free_end(level, angle_bin, scratch)
                              : median_in_range_bin(level, angle_bin, range_bin, scratch);
  }
  return result;
}

std::vector<float> decode_per_bin_median(const NodeLevel& level) {
  std::vector<float> result;
  std::vector<float> scratch;
  for (int a = 0; a < level.bins().angle_bins; ++a) {
    scratch.clear();
    std::copy_if(level.samples(a).begin(), level.samples(a).end(), std::back_inserter(scratch),
                 [](float range_m) { return range_m >= 0.0F; });
    result.push_back(lower_median(scratch));
  }
  return result;
}

}  // namespace strata::memory
