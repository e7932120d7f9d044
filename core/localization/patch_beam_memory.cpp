// SPDX-License-Identifier: Apache-2.0
// What particles remember of a scan.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/localization/column_math.hpp"
#include "core/localization/patch_beam_model.hpp"

namespace strata::localization {

/// What the scan says of the sub-maps that beams of the chunk met, into the rows of its particles;
/// their log-likelihoods get what their own sub-maps add: the mixture over its configurations for
/// the scan as a whole.
void PatchBeamModel::remember(double tempering, ParticleSet& particles, std::size_t begin,
                              std::size_t end, std::span<double> log_likelihood,
                              Scratch& scratch) const {
  SubmapRatios& said = scratch.said;
  const auto is_own = [&](const SubmapRatios::Met& met, std::size_t i) {
    return particles.submap[i] == static_cast<std::int32_t>(met.submap);
  };
  for (double& ratio : said.values()) ratio /= tempering;
  for (const SubmapRatios::Met& met : said.met()) {
    for (std::size_t i = begin; i < end; ++i) {
      double largest = 0.0;
      if (is_own(met, i)) {
        largest = said.at(met.row, i - begin);
        for (std::size_t k = 1; k < met.configurations; ++k) {
          largest = std::max(largest, said.at(met.row + k, i - begin));
        }
        log_likelihood[i] += largest;
      }
      for (std::size_t k = 0; k < met.configurations; ++k) {
        double& ratio = said.at(met.row + k, i - begin);
        ratio = std::min(80.0, ratio - largest);
      }
    }
  }
  exp_column(said.values().data(), said.values().size());
  const bool is_shared = states_.memory() == PatchMemory::kShared;
  const Beliefs believed = beliefs(particles, begin);
  if (is_shared) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::span<float> row = particles.belief(i);
      std::fill(row.begin(), row.end(), 1.0F);
    }
  }
  for (std::size_t place = 0; place < said.met().size(); ++place) {
    const SubmapRatios::Met& met = said.met()[place];
    const std::size_t offset = states_.offset(met.submap);
    scratch.factor.resize(met.configurations);
    const std::span<double> factor(scratch.factor);
    for (std::size_t i = begin; i < end; ++i) {
      if (!said.is_met(place, i - begin)) continue;
      for (std::size_t k = 0; k < factor.size(); ++k) factor[k] = said.at(met.row + k, i - begin);
      const std::span<float> row = particles.belief(i).subspan(offset, factor.size());
      double own = 1.0;
      if (is_own(met, i)) {
        const float* const mine = believed.of(i - begin).data() + offset;
        own = std::inner_product(factor.begin(), factor.end(), mine, 0.0);
        log_likelihood[i] += std::log(own);
      }
      if (!is_shared) {
        update_belief(row, factor, states_.least_belief());
        continue;
      }
      // What absorb() sums: p(z | x_i, m_s = k) over the particle's own likelihood, in which the
      // mixture over its own sub-map counts once.
      for (std::size_t k = 0; k < factor.size(); ++k) {
        row[k] = static_cast<float>(factor[k] / own);
      }
    }
  }
}

}  // namespace strata::localization
