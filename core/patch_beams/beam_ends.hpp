// SPDX-License-Identifier: Apache-2.0
/// The first stages: where the beams of some lasers end for certain, and at what they may end
/// before.
#pragma once

#include <cstdint>
#include <vector>

#include "core/localization/laser_columns.hpp"
#include "core/patch_beams/changing_beams.hpp"
#include "core/patch_beams/chunk.hpp"
#include "core/patch_beams/patch_ray_caster.hpp"
#include "core/patch_beams/seen_boxes.hpp"
#include "core/rays/scan_beams.hpp"
#include "core/rays/scan_mixture.hpp"

namespace strata::patch_beams {

/// What a scan says, the same for all particles.
struct PreparedScan {
  rays::ScanBeams beams;
  rays::ScanMixture mixture;
};

/// Where beams end for certain: rows of one beam, one entry a laser.
struct StaticEnds {
  std::vector<double> range_m;         ///< +infinity: nowhere
  std::vector<double> log_likelihood;  ///< ln p of ending there
};

/// Follows the beams of all lasers to the first cell that ends every ray. O(beams x lasers).
void cast_static(const PreparedScan& scan, const PatchRayCaster& caster,
                 localization::LaserColumns& lasers, StaticEnds& ends);

/// What beams may end at before that, and the working memory of finding it.
struct ChangingEnds {
  SeenBoxes boxes;
  ChangingBeams beams;
};

/// Follows the beams that pass where sub-maps change up to static_m, rows as of StaticEnds. One
/// entry of `states` a laser.
void find_changing(const PreparedScan& scan, const PatchRayCaster& caster,
                   const ChunkStates& states, const double* static_m,
                   localization::LaserColumns& lasers, ChangingEnds& ends);

}  // namespace strata::patch_beams
