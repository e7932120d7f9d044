// SPDX-License-Identifier: Apache-2.0
#include "core/patch_beams/beam_ends.hpp"

#include "core/rays/bundle_kernel.hpp"

namespace strata::patch_beams {

void cast_static(const PreparedScan& scan, const PatchRayCaster& caster,
                 localization::LaserColumns& lasers, StaticEnds& ends) {
  const std::size_t places = scan.beams.size() * lasers.padded();
  ends.range_m.resize(places);
  ends.log_likelihood.resize(places);
  const rays::RayTable still = caster.static_table();
  rays::cast_bundles(still, lasers.bundles(still, scan.beams, scan.beams.r_max_m),
                     ends.range_m.data());
  scan.mixture.log_likelihoods_of_bundles(lasers.padded(), ends.range_m.data(),
                                          ends.log_likelihood.data());
}

void find_changing(const PreparedScan& scan, const PatchRayCaster& caster,
                   const ChunkStates& states, const double* static_m,
                   localization::LaserColumns& lasers, ChangingEnds& ends) {
  const double max_range_m = scan.beams.r_max_m;
  ends.boxes.take(caster, lasers, states, max_range_m);
  const rays::BeamBundles bundles =
      lasers.bundles(caster.changing_table(), scan.beams, max_range_m);
  ends.beams.find(bundles, ends.boxes, static_m);
  ends.beams.follow(caster, bundles, ends.boxes, states, scan.mixture);
}

}  // namespace strata::patch_beams
