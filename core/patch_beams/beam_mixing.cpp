// SPDX-License-Identifier: Apache-2.0
#include "core/patch_beams/beam_mixing.hpp"

#include <algorithm>

#include "core/rays/column_math.hpp"

namespace strata::patch_beams {
namespace {

/// The probability that the cells of each uniform box are there, for each particle that it counts
/// for.
void find_box_shares(const PatchChunk& chunk, const SeenBoxes& boxes,
                     std::vector<double>& box_share) {
  const std::size_t row = boxes.lasers();
  box_share.resize(boxes.size() * row);
  for (std::size_t box = 0; box < boxes.size(); ++box) {
    if (!boxes.is_uniform(box)) continue;
    double* const share = box_share.data() + box * row;
    for (std::size_t n = 0; n < chunk.size(); ++n) {
      if (!boxes.counts(box, n)) continue;
      const CellOwner& cells = boxes.content(box, n);
      const bool is_own = cells.submap == chunk.states.submap[n];
      const bool is_known = is_own && chunk.states.fixed(n) >= 0;
      if (is_known || cells.mask == chunk.caster.all(cells.submap)) {
        share[n] = 1.0;
      } else if (chunk.mixes_whole(cells.submap, is_own)) {
        share[n] = SingleSums::kApart;
      } else {
        const float* const belief = chunk.belief(n, cells.submap);
        share[n] = std::min(1.0, localization::probability_of(cells.mask, belief));
      }
    }
  }
}

}  // namespace

void mix_single(const PatchChunk& chunk, const rays::ScanMixture& mixture, const SeenBoxes& boxes,
                const SingleBeams& beams, std::span<double> log_likelihood, SubmapRatios& ratios,
                SingleMixing& single) {
  single.log_likelihood.assign(chunk.bundles, 0.0);
  if (beams.size() == 0) return;
  find_box_shares(chunk, boxes, single.box_share);
  const std::size_t row = boxes.lasers();
  const bool has_memory = chunk.has_memory();
  const SingleSums::Columns sums =
      single.sums.take(beams, mixture, row, single.box_share, has_memory, log_likelihood.data());
  for (std::size_t box = 0; box < boxes.size(); ++box) {
    if (!boxes.is_uniform(box)) continue;
    std::int32_t submap = -1;  // of the particle before
    std::size_t place = 0;
    for (std::size_t n = 0; n < chunk.size(); ++n) {
      const std::size_t at = box * row + n;
      if (sums.beams[at] == 0.0) continue;
      single.log_likelihood[n] += sums.mixed[at];
      if (!has_memory) continue;
      const CellOwner& cells = boxes.content(box, n);
      if (cells.submap != submap) {
        submap = cells.submap;
        place = ratios.place_of(static_cast<std::size_t>(submap), chunk.rows(submap));
      }
      ratios.meet_again(place, n);
      const SubmapRatios::Met& met = ratios.met()[place];
      for (std::size_t k = 0; k < met.configurations; ++k) {
        ratios.at(met.row + k, n) += (cells.mask >> k & 1U) != 0 ? sums.near[at] : sums.far[at];
      }
    }
  }
}

void mix_pairs(const PairBeams& pairs, std::span<double> log_likelihood, SubmapRatios& ratios,
               std::vector<double>& mixed) {
  mixed.resize(pairs.beams.size());
  rays::mix_logs(pairs.share.data(), pairs.near_log.data(), pairs.far_log.data(), mixed.size(),
                 mixed.data());
  for (std::size_t n = 0; n < mixed.size(); ++n) {
    const PairBeams::Beam& pair = pairs.beams[n];
    log_likelihood[pair.log] = mixed[n];
    const double near = pairs.near_log[n] - mixed[n];
    const double far = pairs.far_log[n] - mixed[n];
    for (std::uint32_t k = 0; k < pair.configurations; ++k) {
      ratios.at(pair.row + k, pair.particle) += (pair.near >> k & 1U) != 0 ? near : far;
    }
  }
}

}  // namespace strata::patch_beams
