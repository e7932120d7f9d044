// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/stored_places.hpp"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "memory/decoding/decode.hpp"

namespace strata::memory {
namespace {

/// Nodes around that may see what the robot sees, in node spacings.
constexpr double kAround = 2.0;
constexpr double kTolerance_m = 0.3;

bool is_of_static(const PosedScan& scan, std::size_t beam) {
  return scan.static_probability.empty() || scan.static_probability[beam] >= 0.5F;
}

}  // namespace

std::shared_ptr<const NodeMap::Level> StoredPlaces::level_of(const TimescaleMemory& memory,
                                                             const DecodingConfig& decoding,
                                                             std::size_t node) {
  const auto [known, is_new] = levels_.try_emplace(node);
  const MemoryNode& here = memory.nodes()[node];
  if (!is_new || here.is_damaged) return known->second;
  std::optional<MemoryNode> read;
  try {
    if (here.is_evicted()) read = memory.loaded(node);
  } catch (const DamageError&) {  // whoever needs it tells
    return nullptr;
  }
  const std::vector<NodeLevel>& levels = read ? read->levels : here.levels;
  for (auto level = levels.rbegin(); level != levels.rend() && !known->second; ++level) {
    if (level->insertions() == 0) continue;
    known->second =
        NodeMap::make_level(memory.config().bins(), memory.config().visibility.own_place_m,
                            level->insertions(), decode(*level, decoding));
  }
  return known->second;
}

FrameLook StoredPlaces::agreement(const TimescaleMemory& memory, const DecodingConfig& decoding,
                                  const PosedScan& scan) {
  const Pose2 map_from_laser = scan.map_from_laser();
  const double around_m = kAround * memory.config().node_spacing_m;
  std::vector<NodeMap::Node> nodes;
  for (std::size_t n = 0; n < nodes_ && n < memory.nodes().size(); ++n) {
    const MemoryNode& node = memory.nodes()[n];
    if (!((node.position_m - map_from_laser.translation()).norm() <= around_m)) continue;
    auto level = level_of(memory, decoding, n);
    if (level) nodes.push_back({node.position_m, node.observations, {std::move(level)}});
  }
  if (nodes.empty()) return {};
  const NodeMap map(memory.config().bins(), decoding, {"stored"}, std::move(nodes));
  std::vector<double> bearings_rad(scan.scan.size());
  for (std::size_t i = 0; i < bearings_rad.size(); ++i) bearings_rad[i] = scan.scan.bearing_rad(i);
  std::vector<float> expected_m(bearings_rad.size());
  map.expected_ranges_m(0, map_from_laser, bearings_rad, expected_m);
  FrameLook result;
  for (std::size_t i = 0; i < expected_m.size(); ++i) {
    const auto measured_m = static_cast<double>(scan.scan.ranges_m[i]);
    const auto wanted_m = static_cast<double>(expected_m[i]);
    const bool is_known = std::isfinite(wanted_m) && wanted_m > 0.0;  // below: free, then unknown
    if (!is_known || !std::isfinite(measured_m) || !is_of_static(scan, i)) continue;
    ++result.judged;
    result.agreed += std::abs(measured_m - wanted_m) <= kTolerance_m ? 1 : 0;
  }
  return result;
}

}  // namespace strata::memory
