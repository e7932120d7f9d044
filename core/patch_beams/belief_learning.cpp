// SPDX-License-Identifier: Apache-2.0
// Particles go in columns, so that the compiler takes several at once; their beliefs are the bits
// of update_belief.
#include "core/patch_beams/belief_learning.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/rays/column_math.hpp"

namespace strata::patch_beams {
namespace {

using localization::ParticleSet;
using localization::PatchStates;

/// Whether its last row is that of something else.
bool has_something_else(const PatchStates& layout, const SubmapRatios::Met& met) {
  return met.configurations > static_cast<std::size_t>(layout.count(met.submap));
}

/// Brings what the scan says of each sub-map that beams of the chunk met to the tempered scale,
/// less what is largest there, so that no exponential overflows: for the particles in it that goes
/// to their log-likelihoods, and a belief of their own does not ask for the scale. Beliefs that
/// they share weigh the particles by it; there a sub-map they are not in says at most e^80. One
/// that may show something else goes to the log-likelihoods of all particles, as if they were in
/// it.
void scale_ratios(const PatchStates& layout, double tempering, bool is_shared,
                  std::span<const std::int32_t> current, std::span<double> log_likelihood,
                  SubmapRatios& ratios, std::vector<double>& largest) {
  const double per_tempering = 1.0 / tempering;
  for (double& ratio : ratios.values()) ratio *= per_tempering;
  largest.resize(current.size());
  for (const SubmapRatios::Met& met : ratios.met()) {
    const auto submap = static_cast<std::int32_t>(met.submap);
    const bool is_for_all = has_something_else(layout, met);
    std::copy_n(&ratios.at(met.row, 0), largest.size(), largest.begin());
    for (std::size_t k = 1; k < met.configurations; ++k) {
      const double* const ratio = &ratios.at(met.row + k, 0);
      for (std::size_t n = 0; n < largest.size(); ++n) largest[n] = std::max(largest[n], ratio[n]);
    }
    for (std::size_t n = 0; n < largest.size(); ++n) {
      const bool is_own = is_for_all || current[n] == submap;
      log_likelihood[n] += is_own ? largest[n] : 0.0;
      largest[n] = is_own || !is_shared ? largest[n] : 0.0;
    }
    for (std::size_t k = 0; k < met.configurations; ++k) {
      double* const ratio = &ratios.at(met.row + k, 0);
      for (std::size_t n = 0; n < largest.size(); ++n) ratio[n] -= largest[n];
    }
  }
  for (double& ratio : ratios.values()) ratio = std::min(80.0, ratio);
}

/// Beliefs of one sub-map, of each of `count` particles that met it: b(k) <- b(k) factor(k), as
/// update_belief. Leaves the sums before normalizing in columns.sum.
void update_beliefs(const PatchStates& layout, std::size_t place, std::size_t begin,
                    std::size_t count, SubmapRatios& ratios, ParticleSet& particles,
                    BeliefColumns& columns) {
  const SubmapRatios::Met& met = ratios.met()[place];
  const std::size_t offset = layout.offset(met.submap);
  const double least = layout.min_belief();
  const std::size_t known = static_cast<std::size_t>(layout.count(met.submap));
  columns.product.resize(met.configurations * count);
  columns.sum.assign(count, 0.0);
  columns.clamped.assign(count, 0.0);
  double* const sum = columns.sum.data();
  double* const clamped = columns.clamped.data();
  for (std::size_t k = 0; k < met.configurations; ++k) {
    double* const product = columns.product.data() + k * count;
    const double* const factor = &ratios.at(met.row + k, 0);
    const float* const belief = particles.belief(begin).data() + offset + k;
    for (std::size_t n = 0; n < count && k < known; ++n) {
      product[n] = static_cast<double>(belief[n * particles.belief_columns]) * factor[n];
    }
    for (std::size_t n = 0; n < count && k == known; ++n) {
      const std::span<const float> row = particles.belief(begin + n).subspan(offset, known);
      product[n] = localization::left_of(row) * factor[n];
    }
    for (std::size_t n = 0; n < count; ++n) sum[n] += product[n];
  }
  for (std::size_t k = 0; k < met.configurations; ++k) {
    double* const product = columns.product.data() + k * count;
    // Something else may come at any time.
    const double floor = k < known ? least : static_cast<double>(layout.something_else(met.submap));
    for (std::size_t n = 0; n < count; ++n) product[n] = std::max(floor, product[n] / sum[n]);
    for (std::size_t n = 0; n < count; ++n) clamped[n] += product[n];
  }
  for (std::size_t n = 0; n < count; ++n) {
    if (!ratios.is_met(place, n) || !(sum[n] > 0.0) || !std::isfinite(sum[n])) continue;
    const std::span<float> row = particles.belief(begin + n).subspan(offset, known);
    for (std::size_t k = 0; k < row.size(); ++k) {
      const auto b = static_cast<float>(columns.product[k * count + n]);
      row[k] = static_cast<float>(static_cast<double>(b) / clamped[n]);
    }
  }
}

/// What absorb() sums, into the rows of the particles: p(z | x_i, m_s = k) over the particle's own
/// likelihood, in which the mixture over its own sub-map counts once. Leaves that mixture in `own`.
void write_ratios(const PatchStates& layout, std::size_t place,
                  std::span<const std::int32_t> current, std::size_t begin, SubmapRatios& ratios,
                  ParticleSet& particles, std::vector<double>& own) {
  const SubmapRatios::Met& met = ratios.met()[place];
  const std::size_t offset = layout.offset(met.submap);
  own.assign(current.size(), 1.0);
  for (std::size_t n = 0; n < current.size(); ++n) {
    if (!ratios.is_met(place, n)) continue;
    if (current[n] == static_cast<std::int32_t>(met.submap)) {
      own[n] = 0.0;
      for (std::size_t k = 0; k < met.configurations; ++k) {
        const auto b = static_cast<double>(particles.shared_belief[offset + k]);
        own[n] += b * ratios.at(met.row + k, n);
      }
    }
    const std::span<float> row = particles.belief(begin + n).subspan(offset, met.configurations);
    for (std::size_t k = 0; k < row.size(); ++k) {
      row[k] = static_cast<float>(ratios.at(met.row + k, n) / own[n]);
    }
  }
}

/// Adds the logarithm of its mixture to the particles that are in a sub-map, or to all that met one
/// that may show something else; that of others says nothing.
void add_own_mixture(const PatchStates& layout, std::size_t place,
                     std::span<const std::int32_t> current, const SubmapRatios& ratios,
                     std::vector<double>& mixture, std::span<double> log_likelihood) {
  const auto submap = static_cast<std::int32_t>(ratios.met()[place].submap);
  const bool is_for_all = has_something_else(layout, ratios.met()[place]);
  bool any = false;
  for (std::size_t n = 0; n < current.size(); ++n) {
    const bool is_own = (is_for_all || current[n] == submap) && ratios.is_met(place, n);
    if (!is_own) mixture[n] = 1.0;
    any = any || is_own;
  }
  if (!any) return;
  rays::log_column(mixture.data(), current.size());
  for (std::size_t n = 0; n < current.size(); ++n) log_likelihood[n] += mixture[n];
}

}  // namespace

void learn_beliefs(const PatchStates& layout, double tempering, std::size_t begin,
                   std::span<double> log_likelihood, SubmapRatios& ratios, ParticleSet& particles,
                   BeliefColumns& columns) {
  const std::size_t count = log_likelihood.size();
  const auto current = std::span<const std::int32_t>(particles.submap).subspan(begin, count);
  const bool is_shared = layout.memory() == localization::PatchMemory::kShared;
  scale_ratios(layout, tempering, is_shared, current, log_likelihood, ratios, columns.sum);
  rays::exp_column(ratios.values().data(), ratios.values().size());
  if (is_shared) {
    float* const rows = particles.belief(begin).data();
    std::fill(rows, rows + count * particles.belief_columns, 1.0F);
  }
  for (std::size_t place = 0; place < ratios.met().size(); ++place) {
    if (is_shared) {
      write_ratios(layout, place, current, begin, ratios, particles, columns.sum);
    } else {
      update_beliefs(layout, place, begin, count, ratios, particles, columns);
    }
    add_own_mixture(layout, place, current, ratios, columns.sum, log_likelihood);
  }
}

}  // namespace strata::patch_beams
