// SPDX-License-Identifier: Apache-2.0
// Which cells a mask of zones has, and which zones it shows.
#include <cstddef>
#include <string>

#include "components/site/zone_masks.hpp"
#include "core/base/error.hpp"

namespace strata::site {
namespace {

constexpr std::size_t kMaxMaskCells = 40'000'000;

/// The cells of the map and of the zones that `is_shown` takes.
template <typename IsShown>
CellRect rect_of(const Zones& zones, const ReflectionGrid& map, IsShown&& is_shown) {
  CellRect rect = map.rect();
  for (const Zone& zone : zones.zones) {
    if (!is_shown(zone)) continue;
    for (const MetricPolygon& polygon : zone.shape) {
      rect = rect.united(cells_around(polygon, map.resolution_m()));
    }
  }
  if (rect.empty()) rect = {{0, 0}, {1, 1}};
  if (rect.area() <= kMaxMaskCells) return rect;
  const bool is_map = map.rect().area() > kMaxMaskCells;
  throw InputError(kZonesFile,
                   "makes a mask of " + std::to_string(rect.width()) + " x " +
                       std::to_string(rect.height()) + " cells, with the map",
                   std::string("40 million cells are the most; ") +
                       (is_map ? "the map alone has more: learn it with larger cells, or as two"
                               : "draw the zones where the map is"));
}

}  // namespace

bool shows(MaskKind kind, const Zone& zone) {
  switch (kind) {
    case MaskKind::kKeepout:
      return zone.kind == ZoneKind::kKeepout;
    case MaskKind::kPreferred:
      return zone.kind == ZoneKind::kPreferred;
    case MaskKind::kSpeedPercent:
      return zone.speed_percent.has_value();
    case MaskKind::kSpeedMetres:
      return zone.speed_m_s.has_value();
    case MaskKind::kNeverLearn:
    case MaskKind::kStaticOnly:
      return zone.kind == ZoneKind::kLearn;
  }
  return false;
}

CellRect mask_rect(const Zones& zones, const ReflectionGrid& map) {
  return rect_of(zones, map, [](const Zone&) { return true; });
}

CellRect mask_rect(const Zones& zones, const ReflectionGrid& map, MaskKind kind) {
  return rect_of(zones, map, [kind](const Zone& zone) { return shows(kind, zone); });
}

void require_masks(const Zones& zones, const ReflectionGrid& map) {
  for (const MaskKind kind : all_mask_kinds()) {
    // What is learned is learned without a mask.
    if (kind == MaskKind::kNeverLearn || kind == MaskKind::kStaticOnly) continue;
    for (const Zone& zone : zones.zones) {
      if (!shows(kind, zone)) continue;
      (void)mask_of(zones, kind, map, mask_rect(zones, map, kind));
      break;
    }
  }
}

}  // namespace strata::site
