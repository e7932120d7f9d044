// SPDX-License-Identifier: Apache-2.0
/// The last stage: what particles with a memory learn from a scan of the sub-maps that beams met.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/localization/particle_set.hpp"
#include "core/localization/patch_states.hpp"
#include "core/patch_beams/submap_ratios.hpp"

namespace strata::patch_beams {

/// Working memory: the beliefs of one sub-map on their way. One entry a particle; `product` has a
/// row of these for each configuration.
struct BeliefColumns {
  std::vector<double> product, sum, clamped;
};

/// Puts what the scan says of the sub-maps into the belief rows of the chunk's particles, those
/// from `begin` on: learned beliefs, or with a shared memory what PatchStates::absorb sums. Their
/// log-likelihoods, one entry a particle of the chunk, get what their own sub-maps add: the mixture
/// over its configurations for the scan as a whole. Uses up `ratios`. O(particles x configurations
/// of the sub-maps that beams met).
void learn_beliefs(const localization::PatchStates& layout, double tempering, std::size_t begin,
                   std::span<double> log_likelihood, SubmapRatios& ratios,
                   localization::ParticleSet& particles, BeliefColumns& columns);

}  // namespace strata::patch_beams
