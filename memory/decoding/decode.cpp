// SPDX-License-Identifier: Apache-2.0
#include "memory/decoding/decode.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "memory/decoding/graph.hpp"

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
std::uint8_t most_frequent(const NodeLevel& level, int angle_bin) {
  std::array<int, 256> count{};
  for (const float range_m : level.samples(angle_bin)) ++count[level.bins().range_bin(range_m)];
  return static_cast<std::uint8_t>(std::max_element(count.begin(), count.end()) - count.begin());
}

float median_in_range_bin(const NodeLevel& level, int angle_bin, std::uint8_t range_bin,
                          std::vector<float>& scratch) {
  scratch.clear();
  for (const float range_m : level.samples(angle_bin)) {
    if (level.bins().range_bin(range_m) == range_bin) scratch.push_back(range_m);
  }
  return lower_median(scratch);
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
  for (std::size_t row = 0; row < graph.rows(); ++row) {
    const int angle_bin = static_cast<int>(row);
    if (level.samples(angle_bin).empty()) continue;
    std::uint8_t range_bin =
        path.found ? graph.states(row)[path.states[row]] : LayeredGraph::kWildcard;
    if (range_bin == LayeredGraph::kWildcard) range_bin = most_frequent(level, angle_bin);
    result.range_m[row] = median_in_range_bin(level, angle_bin, range_bin, scratch);
  }
  return result;
}

std::vector<float> decode_per_bin_median(const NodeLevel& level) {
  std::vector<float> result;
  std::vector<float> scratch;
  for (int a = 0; a < level.bins().angle_bins; ++a) {
    scratch.assign(level.samples(a).begin(), level.samples(a).end());
    result.push_back(lower_median(scratch));
  }
  return result;
}

}  // namespace strata::memory
