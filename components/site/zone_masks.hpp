// SPDX-License-Identifier: Apache-2.0
/// Zones as masks of cells, as nav2's costmap filters take them, and back.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "components/site/zones.hpp"
#include "core/grid/reflection_grid.hpp"

namespace strata::site {

enum class MaskKind {
  kKeepout,       ///< for KeepoutFilter
  kPreferred,     ///< for KeepoutFilter: what lies outside costs
  kSpeedPercent,  ///< for SpeedFilter
  kSpeedMetres,   ///< for SpeedFilter
  kNeverLearn,    ///< for BinaryFilter
  kStaticOnly,    ///< for BinaryFilter
};
/// "keepout", "preferred", "speed", "speed_m_s", "never_learn", "static_only".
[[nodiscard]] const char* name_of(MaskKind kind);
[[nodiscard]] std::span<const MaskKind> all_mask_kinds();
/// Of one of these names. Throws InputError.
[[nodiscard]] MaskKind mask_kind(const std::string& name);

/// What nav2_msgs/CostmapFilterInfo says of a mask: value v of it means base + multiplier v.
struct FilterMeaning {
  std::uint8_t type = 0;  ///< 0 keepout, 1 speed in percent, 2 speed in m/s, 3 binary
  float base = 0.0F;
  float multiplier = 1.0F;
  friend bool operator==(const FilterMeaning&, const FilterMeaning&) = default;
};

struct MaskConfig {
  double preferred_cost_percent = 30.0;  ///< of what lies outside of preferred zones
};

/// Values of nav_msgs/OccupancyGrid over 100, unknown for -1.
struct ZoneMask {
  ReflectionGrid values;
  FilterMeaning meaning;
};

/// Whether a mask of that kind says something of the zone.
[[nodiscard]] bool shows(MaskKind kind, const Zone& zone);

/// The cells of a map and of all zones. Throws InputError where they are more than 40 million.
[[nodiscard]] CellRect mask_rect(const Zones& zones, const ReflectionGrid& map);
/// ... of the zones that a mask of that kind shows: others do not stop it.
[[nodiscard]] CellRect mask_rect(const Zones& zones, const ReflectionGrid& map, MaskKind kind);

/// Of cells whose middle lies in a zone (docs/site.md, "Zones"), over `rect` with the cells of
/// `map`. Where zones overlap the greatest cost and the lowest speed hold, limits are rounded down.
/// Preferred zones change nothing where the map is unknown, which would else be passable. Throws
/// InputError where speeds in m/s are too far apart for one mask. O(cells + corners).
[[nodiscard]] ZoneMask mask_of(const Zones& zones, MaskKind kind, const ReflectionGrid& map,
                               const CellRect& rect, const MaskConfig& config = {});

/// Throws what mask_rect() and mask_of() throw of a kind that keeps robots from driving, or slows
/// them, where the map has these zones. O(cells).
void require_masks(const Zones& zones, const ReflectionGrid& map);

/// One line for people about zones that do nothing since no cell of `rect` has its middle in them,
/// such as a line of tape; empty when there are none. O(cells + corners).
[[nodiscard]] std::string narrow_zones(const Zones& zones, double resolution_m,
                                       const CellRect& rect);

/// What may be learned in each cell of `rect`; where zones of kind learn overlap, the smallest
/// holds, and of two alike the stricter. Values are those of LearnControl. O(cells + corners).
[[nodiscard]] Grid<std::uint8_t> learn_control(const Zones& zones, double resolution_m,
                                               const CellRect& rect);

/// The zones of a mask, one for each value that means something, as features of a document: named
/// `name`, with the value behind it where there are several. mask_of() makes the same cells of
/// them, of the values that a mask of ours has. place: the mask, for errors. Throws InputError for
/// values that no zone can have. O(cells log cells).
[[nodiscard]] Zones zones_of_mask(const ReflectionGrid& mask, MaskKind kind,
                                  const FilterMeaning& meaning, const std::string& name,
                                  const std::string& frame, const std::string& place);
/// Of a mask without a word on what it means: as mask_of() makes it.
[[nodiscard]] FilterMeaning usual_meaning(MaskKind kind);

}  // namespace strata::site
