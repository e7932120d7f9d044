// SPDX-License-Identifier: Apache-2.0
#include "memory/levels/node_level.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace strata::memory {

NodeLevel::NodeLevel(const PolarBins& bins, int capacity, bool coupled_eviction)
    : bins_(bins),
      capacity_(static_cast<std::size_t>(capacity)),
      coupled_eviction_(coupled_eviction),
      sample_counts_(static_cast<std::size_t>(bins.angle_bins)),
      pair_counts_(static_cast<std::size_t>(bins.angle_bins)),
      samples_(static_cast<std::size_t>(bins.angle_bins) * capacity_),
      pairs_(static_cast<std::size_t>(bins.angle_bins) * capacity_) {}

std::span<const float> NodeLevel::samples(int angle_bin) const {
  const auto bin = static_cast<std::size_t>(angle_bin);
  return {samples_.data() + bin * capacity_, sample_counts_[bin]};
}

std::span<const RangePair> NodeLevel::pairs(int angle_bin) const {
  const auto bin = static_cast<std::size_t>(angle_bin);
  return {pairs_.data() + bin * capacity_, pair_counts_[bin]};
}

std::size_t NodeLevel::sample_count() const {
  return std::accumulate(sample_counts_.begin(), sample_counts_.end(), std::size_t{0});
}

std::size_t NodeLevel::pair_count() const {
  return std::accumulate(pair_counts_.begin(), pair_counts_.end(), std::size_t{0});
}

void NodeLevel::drop_pair_from(std::size_t bin, std::uint8_t alpha, RandomStream& random) {
  RangePair* const pairs = pairs_.data() + bin * capacity_;
  std::uint16_t& count = pair_counts_[bin];
  std::uint32_t matching = 0;
  for (std::size_t i = 0; i < count; ++i) matching += pairs[i].alpha == alpha ? 1U : 0U;
  if (matching == 0) return;
  std::uint32_t chosen = random.below(matching);
  for (std::size_t i = 0; i < count; ++i) {
    if (pairs[i].alpha != alpha || chosen-- != 0) continue;
    pairs[i] = pairs[--count];
    return;
  }
}

void NodeLevel::insert_sample(std::size_t bin, float range_m, RandomStream& random) {
  float* const samples = samples_.data() + bin * capacity_;
  std::uint16_t& count = sample_counts_[bin];
  if (count < capacity_) {
    samples[count++] = range_m;
    return;
  }
  float& leaving = samples[random.below(static_cast<std::uint32_t>(capacity_))];
  if (coupled_eviction_) drop_pair_from(bin, bins_.state_bin(leaving), random);
  leaving = range_m;
}

void NodeLevel::insert_pair(std::size_t bin, RangePair pair, RandomStream& random) {
  RangePair* const pairs = pairs_.data() + bin * capacity_;
  std::uint16_t& count = pair_counts_[bin];
  if (count < capacity_) {
    pairs[count++] = pair;
  } else {
    pairs[random.below(static_cast<std::uint32_t>(capacity_))] = pair;
  }
}

void NodeLevel::insert(const VirtualScan& scan, RandomStream& random) {
  ++insertions_;
  const auto count = static_cast<std::size_t>(bins_.angle_bins);
  for (std::size_t a = 0; a < count; ++a) {
    if (!std::isnan(scan[a])) insert_sample(a, scan[a], random);
  }
  for (std::size_t a = 0; a < count; ++a) {
    const float next = scan[a + 1 == count ? 0 : a + 1];
    if (std::isnan(scan[a]) || std::isnan(next)) continue;
    insert_pair(a, {bins_.state_bin(scan[a]), bins_.state_bin(next)}, random);
  }
}

namespace {

/// One set of `absorb`; returns its new size.
template <typename T>
std::uint16_t renew(std::span<T> places, std::uint16_t count, std::span<const T> newer,
                    double share, RandomStream& random) {
  if (newer.empty()) return count;
  for (std::size_t i = 0; i < count; ++i) {
    if (!random.bernoulli(share)) continue;
    places[i] = newer[random.below(static_cast<std::uint32_t>(newer.size()))];
  }
  for (std::size_t k = 0; count < places.size() && k < newer.size(); ++k) {
    places[count++] = newer[k];
  }
  return count;
}

}  // namespace

void NodeLevel::absorb(const NodeLevel& newer, double share, RandomStream& random) {
  ++insertions_;
  for (int a = 0; a < bins_.angle_bins; ++a) {
    const auto bin = static_cast<std::size_t>(a);
    sample_counts_[bin] = renew(std::span(samples_).subspan(bin * capacity_, capacity_),
                                sample_counts_[bin], newer.samples(a), share, random);
    pair_counts_[bin] = renew(std::span(pairs_).subspan(bin * capacity_, capacity_),
                              pair_counts_[bin], newer.pairs(a), share, random);
  }
}

void NodeLevel::clear() {
  std::fill(sample_counts_.begin(), sample_counts_.end(), std::uint16_t{0});
  std::fill(pair_counts_.begin(), pair_counts_.end(), std::uint16_t{0});
}

bool NodeLevel::has_room() const {
  const auto fits = [this](std::uint16_t count) { return count <= capacity_; };
  return std::all_of(sample_counts_.begin(), sample_counts_.end(), fits) &&
         std::all_of(pair_counts_.begin(), pair_counts_.end(), fits);
}

bool NodeLevel::is_sound() const {
  const float least_m = bins_.tells_beyond() ? -static_cast<float>(bins_.max_range_m) : 0.0F;
  const auto is_bin = [this](std::uint8_t bin) {
    return bin <= bins_.overflow_bin() || (bins_.tells_beyond() && bin == bins_.beyond_bin());
  };
  for (int a = 0; a < bins_.angle_bins; ++a) {
    for (const float range_m : samples(a)) {
      if (!(range_m >= 0.0F || range_m > least_m)) return false;  // nor NaN
    }
    for (const RangePair& pair : pairs(a)) {
      if (!is_bin(pair.alpha) || !is_bin(pair.beta)) return false;
    }
  }
  return true;
}

}  // namespace strata::memory
