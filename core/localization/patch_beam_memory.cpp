// SPDX-License-Identifier: Apache-2.0
// What particles remember of a scan. Particles go in columns, so that the compiler takes several at
// once; their beliefs are the bits of update_belief.
#include <algorithm>
#include <cmath>

#include "core/localization/column_math.hpp"
#include "core/localization/patch_beam_model.hpp"

namespace strata::localization {

/// Brings what the scan says of each sub-map that beams of the chunk met to the tempered scale,
/// less what is largest there, so that no exponential overflows: for the particles in it that goes
/// to their log-likelihoods, and a belief of their own does not ask for the scale. Beliefs that
/// they share weigh the particles by it; there a sub-map they are not in says at most e^80.
void PatchBeamModel::scale_ratios(double tempering, std::span<const std::int32_t> current,
                                  std::span<double> log_likelihood, SubmapRatios& said,
                                  std::vector<double>& largest) const {
  const double per_tempering = 1.0 / tempering;
  const bool is_shared = states_.memory() == PatchMemory::kShared;
  for (double& ratio : said.values()) ratio *= per_tempering;
  largest.resize(current.size());
  for (const SubmapRatios::Met& met : said.met()) {
    const auto submap = static_cast<std::int32_t>(met.submap);
    std::copy_n(&said.at(met.row, 0), largest.size(), largest.begin());
    for (std::size_t k = 1; k < met.configurations; ++k) {
      const double* const ratio = &said.at(met.row + k, 0);
      for (std::size_t n = 0; n < largest.size(); ++n) largest[n] = std::max(largest[n], ratio[n]);
    }
    for (std::size_t n = 0; n < largest.size(); ++n) {
      const bool is_own = current[n] == submap;
      log_likelihood[n] += is_own ? largest[n] : 0.0;
      largest[n] = is_own || !is_shared ? largest[n] : 0.0;
    }
    for (std::size_t k = 0; k < met.configurations; ++k) {
      double* const ratio = &said.at(met.row + k, 0);
      for (std::size_t n = 0; n < largest.size(); ++n) ratio[n] -= largest[n];
    }
  }
  for (double& ratio : said.values()) ratio = std::min(80.0, ratio);
}

/// Beliefs of one sub-map, of each particle that met it: b(k) <- b(k) factor(k), as update_belief.
/// Leaves the sums before normalizing in `update`.
void PatchBeamModel::update_beliefs(std::size_t place, std::size_t begin, std::size_t count,
                                    SubmapRatios& said, ParticleSet& particles,
                                    BeliefUpdate& update) const {
  const SubmapRatios::Met& met = said.met()[place];
  const std::size_t offset = states_.offset(met.submap);
  const double least = states_.least_belief();
  update.product.resize(met.configurations * count);
  update.sum.assign(count, 0.0);
  update.clamped.assign(count, 0.0);
  double* const sum = update.sum.data();
  double* const clamped = update.clamped.data();
  for (std::size_t k = 0; k < met.configurations; ++k) {
    double* const product = update.product.data() + k * count;
    const double* const factor = &said.at(met.row + k, 0);
    const float* const belief = particles.belief(begin).data() + offset + k;
    for (std::size_t n = 0; n < count; ++n) {
      product[n] = static_cast<double>(belief[n * particles.belief_columns]) * factor[n];
    }
    for (std::size_t n = 0; n < count; ++n) sum[n] += product[n];
  }
  for (std::size_t k = 0; k < met.configurations; ++k) {
    double* const product = update.product.data() + k * count;
    for (std::size_t n = 0; n < count; ++n) product[n] = std::max(least, product[n] / sum[n]);
    for (std::size_t n = 0; n < count; ++n) clamped[n] += product[n];
  }
  for (std::size_t n = 0; n < count; ++n) {
    if (!said.is_met(place, n) || !(sum[n] > 0.0) || !std::isfinite(sum[n])) continue;
    const std::span<float> row = particles.belief(begin + n).subspan(offset, met.configurations);
    for (std::size_t k = 0; k < row.size(); ++k) {
      const auto b = static_cast<float>(update.product[k * count + n]);
      row[k] = static_cast<float>(static_cast<double>(b) / clamped[n]);
    }
  }
}

/// What absorb() sums, into the rows of the particles: p(z | x_i, m_s = k) over the particle's own
/// likelihood, in which the mixture over its own sub-map counts once. Leaves that mixture in
/// `update`.
void PatchBeamModel::write_ratios(std::size_t place, std::span<const std::int32_t> current,
                                  std::size_t begin, SubmapRatios& said, ParticleSet& particles,
                                  BeliefUpdate& update) const {
  const SubmapRatios::Met& met = said.met()[place];
  const std::size_t offset = states_.offset(met.submap);
  update.sum.assign(current.size(), 1.0);
  for (std::size_t n = 0; n < current.size(); ++n) {
    if (!said.is_met(place, n)) continue;
    if (current[n] == static_cast<std::int32_t>(met.submap)) {
      update.sum[n] = 0.0;
      for (std::size_t k = 0; k < met.configurations; ++k) {
        const auto b = static_cast<double>(particles.shared_belief[offset + k]);
        update.sum[n] += b * said.at(met.row + k, n);
      }
    }
    const std::span<float> row = particles.belief(begin + n).subspan(offset, met.configurations);
    for (std::size_t k = 0; k < row.size(); ++k) {
      row[k] = static_cast<float>(said.at(met.row + k, n) / update.sum[n]);
    }
  }
}

/// What the scan says of the sub-maps that beams of the chunk met, into the rows of its particles;
/// their log-likelihoods get what their own sub-maps add: the mixture over its configurations for
/// the scan as a whole.
void PatchBeamModel::remember(double tempering, ParticleSet& particles, std::size_t begin,
                              std::size_t end, std::span<double> log_likelihood,
                              Scratch& scratch) const {
  SubmapRatios& said = scratch.said;
  const std::size_t count = end - begin;
  const auto current = std::span<const std::int32_t>(particles.submap).subspan(begin, count);
  const std::span<double> logs = log_likelihood.subspan(begin, count);
  scale_ratios(tempering, current, logs, said, scratch.update.sum);
  exp_column(said.values().data(), said.values().size());
  const bool is_shared = states_.memory() == PatchMemory::kShared;
  if (is_shared) {
    float* const rows = particles.belief(begin).data();
    std::fill(rows, rows + count * particles.belief_columns, 1.0F);
  }
  BeliefUpdate& update = scratch.update;
  for (std::size_t place = 0; place < said.met().size(); ++place) {
    if (is_shared) {
      write_ratios(place, current, begin, said, particles, update);
    } else {
      update_beliefs(place, begin, count, said, particles, update);
    }
    // Its own mixture is the sum; that of others says nothing.
    const auto submap = static_cast<std::int32_t>(said.met()[place].submap);
    bool any = false;
    for (std::size_t n = 0; n < count; ++n) {
      const bool is_own = current[n] == submap && said.is_met(place, n);
      if (!is_own) update.sum[n] = 1.0;
      any = any || is_own;
    }
    if (!any) continue;
    log_column(update.sum.data(), count);
    for (std::size_t n = 0; n < count; ++n) logs[n] += update.sum[n];
  }
}

}  // namespace strata::localization
