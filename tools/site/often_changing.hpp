// SPDX-License-Identifier: Apache-2.0
/// Places that change, as zones for people to look at.
#pragma once

#include <string>

#include "components/site/zones.hpp"
#include "core/patch/patch_map.hpp"

namespace strata::site {

/// One zone of kind learn, control learn, which by itself changes nothing, for each sub-map with
/// cells that its configurations disagree on: those cells and their neighbours.
/// Properties: `changes_per_hour` (null where
/// nobody knows), `configurations`, `area_m2`. The fastest first. O(cells of the sub-maps).
[[nodiscard]] Zones often_changing(const patch::PatchMap& map, const std::string& frame);

}  // namespace strata::site
