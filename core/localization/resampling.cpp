// SPDX-License-Identifier: Apache-2.0
#include "core/localization/resampling.hpp"

#include <bit>
#include <cmath>

#include "core/localization/particle_kernels.hpp"

namespace strata::localization {
namespace {

std::uint64_t bin_of(const ParticleSet& particles, std::size_t i, const KldConfig& config) {
  const auto part = [](double value, double bin) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(value / bin)));
  };
  // 20 bits each for x and y, 6 for the heading (bin_rad >= 0.1), 10 for s, 8 for k.
  return (part(particles.x_m[i], config.bin_m) & 0xFFFFFU) |
         (part(particles.y_m[i], config.bin_m) & 0xFFFFFU) << 20U |
         (part(particles.theta_rad[i], config.bin_rad) & 0x3FU) << 40U |
         (static_cast<std::uint64_t>(particles.submap[i] + 1) & 0x3FFU) << 46U |
         (static_cast<std::uint64_t>(particles.configuration[i] + 1) & 0xFFU) << 56U;
}

}  // namespace

void draw_low_variance(const std::vector<double>& weights, std::size_t count, double offset,
                       std::vector<std::uint32_t>& indices) {
  indices.resize(count);
  const double total = sum_of(weights.data(), weights.size());
  const double step = total / static_cast<double>(count);
  std::size_t i = 0;
  double cumulated = weights.empty() ? 0.0 : weights[0];
  for (std::size_t j = 0; j < count; ++j) {
    const double target = (offset + static_cast<double>(j)) * step;
    while (cumulated <= target && i + 1 < weights.size()) cumulated += weights[++i];
    indices[j] = static_cast<std::uint32_t>(i);
  }
}

std::size_t kld_particle_count(std::size_t bins, double epsilon, double quantile) {
  if (bins <= 1) return 1;
  const double k = static_cast<double>(bins - 1);
  const double part = 2.0 / (9.0 * k);
  const double root = 1.0 - part + std::sqrt(part) * quantile;
  return static_cast<std::size_t>(std::ceil(k / (2.0 * epsilon) * root * root * root));
}

std::size_t count_bins(const ParticleSet& particles, const std::vector<std::uint32_t>& indices,
                       const KldConfig& config, std::vector<std::uint64_t>& scratch) {
  constexpr std::uint64_t kEmpty = ~std::uint64_t{0};
  const std::size_t slots = std::bit_ceil(2 * indices.size() + 1);
  scratch.assign(slots, kEmpty);
  std::size_t bins = 0;
  std::uint32_t previous = ~std::uint32_t{0};
  for (const std::uint32_t index : indices) {
    if (index == previous) continue;  // copies of one particle follow each other
    previous = index;
    const std::uint64_t key = bin_of(particles, index, config);
    std::size_t slot = ((key * 0x9e3779b97f4a7c15ULL) >> 20U) & (slots - 1);
    while (scratch[slot] != kEmpty && scratch[slot] != key) slot = (slot + 1) & (slots - 1);
    if (scratch[slot] == key) continue;
    scratch[slot] = key;
    ++bins;
  }
  return bins;
}

}  // namespace strata::localization
