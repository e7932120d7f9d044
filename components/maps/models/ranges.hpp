// SPDX-License-Identifier: Apache-2.0
/// What several map models share.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>

#include "components/maps/map_model.hpp"
#include "core/rays/ray_caster.hpp"

namespace strata::maps {

/// Of a ray caster, a cell: a distance, and whether it is known. The map itself is not kept.
inline constexpr std::size_t kCasterBytes = sizeof(float) + 1;

/// What a provider expects, as best_prediction says it.
template <typename Provider>
RangeFunction ranges_of(std::shared_ptr<const Provider> provider) {
  return [provider = std::move(provider)](const Pose2& laser, double bearing_rad) {
    return static_cast<double>(provider->expected_range_m(laser, bearing_rad));
  };
}

/// Null where there is no filtered map.
[[nodiscard]] inline std::shared_ptr<const rays::RayCaster> caster_of_filtered(const Maps& maps) {
  if (maps.filtered_caster || !has(maps, MapPart::kFiltered)) return maps.filtered_caster;
  return std::make_shared<const rays::RayCaster>(maps.filtered);
}

}  // namespace strata::maps
