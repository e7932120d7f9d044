// SPDX-License-Identifier: Apache-2.0
/// What the beams that met changing cells say of the particles, and of the sub-maps that they met:
/// docs/theory/patch_beams.md, "Mixing".
///
/// Rows of beams come in with ln p of where each beam ends for certain, and go out with what it
/// says under the beliefs; `ratios` gets ln p(beam | configuration k) less that, summed up.
#pragma once

#include <span>
#include <vector>

#include "core/patch_beams/changing_beams.hpp"
#include "core/patch_beams/chunk.hpp"
#include "core/patch_beams/met_beams.hpp"
#include "core/patch_beams/seen_boxes.hpp"
#include "core/patch_beams/single_sums.hpp"
#include "core/patch_beams/submap_ratios.hpp"
#include "core/rays/scan_mixture.hpp"

namespace strata::patch_beams {

/// What the beams of ChangingBeams::single() say of each particle, and the memory of working it
/// out.
struct SingleMixing {
  std::vector<double> log_likelihood;  ///< sums, one entry a particle
  std::vector<double> box_share;       ///< working memory: that the cells of a box are there
  SingleSums sums;                     ///< the same: of each box and particle
};

/// Mixes the beams that met one uniform box. Their entries in the rows become 0, and
/// single.log_likelihood gets their sums. With memory those that met the particle's own sub-map are
/// not mixed one by one: learn_beliefs() weighs its configurations for the scan as a whole.
void mix_single(const PatchChunk& chunk, const rays::ScanMixture& mixture, const SeenBoxes& boxes,
                const SingleBeams& beams, std::span<double> log_likelihood, SubmapRatios& ratios,
                SingleMixing& single);

/// Mixes the beams that end at one of two places. mixed: working memory.
void mix_pairs(const PairBeams& pairs, std::span<double> log_likelihood, SubmapRatios& ratios,
               std::vector<double>& mixed);

/// Mixes those that may end at more, exactly; O(events) for beams that met each sub-map once,
/// O(configurations x events^2) for others. mixed: working memory.
void mix_several(const PatchChunk& chunk, const SeveralBeams& several,
                 std::span<double> log_likelihood, SubmapRatios& ratios,
                 std::vector<double>& mixed);

}  // namespace strata::patch_beams
