// SPDX-License-Identifier: Apache-2.0
// What particles know of the sub-maps of one patch map, transferred to another.
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/localization/patch_states.hpp"

namespace strata::localization {
namespace {

/// Configurations whose mean squared difference is this much larger look about as much alike.
constexpr double kAlike = 0.02;

/// The old sub-map that corresponds to a new one, and its configurations.
struct Correspondence {
  int before = -1;                         ///< the old sub-map; -1: none
  std::vector<std::vector<float>> shares;  ///< [old configuration][new one], each row sums to 1
  std::vector<std::uint8_t> is_new;        ///< per new configuration: none went to it
};

/// Mean squared difference of two configurations where either sub-map has contradictions.
double difference(const patch::PatchMap& a, std::size_t s, std::size_t k, const patch::PatchMap& b,
                  std::size_t t, std::size_t l) {
  const patch::Submap& of_a = a.submaps[s];
  const patch::Submap& of_b = b.submaps[t];
  const CellRect common = of_a.rect.intersected(of_b.rect);
  double marked = 0.0;
  double marked_cells = 0.0;
  double all = 0.0;
  double all_cells = 0.0;
  for (int y = common.min.y; y < common.max.y; ++y) {
    for (int x = common.min.x; x < common.max.x; ++x) {
      const Cell cell{x, y};
      const float m = patch::reflection_at(a, s, k, cell);
      const float n = patch::reflection_at(b, t, l, cell);
      if (!is_known(m) || !is_known(n)) continue;
      const double d = static_cast<double>(m) - static_cast<double>(n);
      all += d * d;
      all_cells += 1.0;
      if (of_a.contradictory.get(cell) == 0 && of_b.contradictory.get(cell) == 0) continue;
      marked += d * d;
      marked_cells += 1.0;
    }
  }
  if (marked_cells > 0.0) return marked / marked_cells;
  return all_cells > 0.0 ? all / all_cells : 1.0;
}

int overlapping_of(const CellRect& rect, const patch::PatchMap& before) {
  int best = -1;
  std::size_t most = 0;
  for (std::size_t o = 0; o < before.submaps.size(); ++o) {
    const CellRect& other = before.submaps[o].rect;
    const std::size_t common = rect.intersected(other).area();
    if (2 * common <= std::min(rect.area(), other.area()) || common <= most) continue;
    best = static_cast<int>(o);
    most = common;
  }
  return best;
}

Correspondence correspondence_of(const patch::PatchMap& now, std::size_t s,
                                 const patch::PatchMap& before) {
  const std::size_t count = now.submaps[s].configurations.size();
  Correspondence correspondence;
  correspondence.is_new.assign(count, 1);
  correspondence.before = overlapping_of(now.submaps[s].rect, before);
  if (correspondence.before < 0) return correspondence;
  const auto o = static_cast<std::size_t>(correspondence.before);
  for (std::size_t l = 0; l < before.submaps[o].configurations.size(); ++l) {
    std::vector<double> d;
    for (std::size_t k = 0; k < count; ++k) d.push_back(difference(now, s, k, before, o, l));
    const double nearest = *std::min_element(d.begin(), d.end());
    std::vector<float>& row = correspondence.shares.emplace_back(count, 0.0F);
    float alike = 0.0F;
    for (std::size_t k = 0; k < count; ++k) {
      if (d[k] > nearest + kAlike) continue;
      row[k] = 1.0F;
      correspondence.is_new[k] = 0;
      alike += 1.0F;
    }
    for (float& share : row) share /= alike;
  }
  return correspondence;
}

/// to: one sub-map's columns, usual: how often each of its configurations is there.
void transfer(const Correspondence& correspondence, std::span<const float> from,
              std::span<const float> usual, std::span<float> to) {
  std::fill(to.begin(), to.end(), 0.0F);
  for (std::size_t l = 0; l < correspondence.shares.size(); ++l) {
    for (std::size_t k = 0; k < to.size(); ++k) to[k] += from[l] * correspondence.shares[l][k];
  }
  float fresh = 0.0F;
  for (std::size_t k = 0; k < to.size(); ++k) {
    if (correspondence.is_new[k] != 0) fresh += usual[k];
  }
  for (std::size_t k = 0; k < to.size(); ++k) {
    to[k] = correspondence.is_new[k] != 0 ? usual[k] : to[k] * (1.0F - fresh);
  }
}

/// The new configuration of a particle that had the old one; drawn from those alike.
int successor(const Correspondence& correspondence, std::size_t old, RandomStream& random) {
  const std::vector<float>& row = correspondence.shares[old];
  double left = random.uniform();
  for (std::size_t k = 0; k < row.size(); ++k) {
    left -= static_cast<double>(row[k]);
    if (left < 0.0) return static_cast<int>(k);
  }
  return static_cast<int>(std::max_element(row.begin(), row.end()) - row.begin());
}

}  // namespace

void PatchStates::adopt(const PatchStates* before, std::uint64_t seed, std::uint64_t step,
                        ParticleSet& particles) const {
  const ParticleSet old = particles;
  prepare(particles);
  const bool is_same_kind = before != nullptr && before->memory() == memory();
  std::vector<Correspondence> correspondences(is_same_kind ? map_->submaps.size() : 0);
  for (std::size_t s = 0; s < correspondences.size(); ++s) {
    correspondences[s] = correspondence_of(*map_, s, *before->map_);
  }
  // Where a particle goes that holds an old sub-map's configuration.
  std::vector<int> successors(is_same_kind ? before->map_->submaps.size() : 0, -1);
  for (std::size_t s = correspondences.size(); s-- > 0;) {
    if (correspondences[s].before >= 0) {
      successors[static_cast<std::size_t>(correspondences[s].before)] = static_cast<int>(s);
    }
  }
  const auto transfer_row = [&](std::span<const float> from, std::span<float> to) {
    for (std::size_t s = 0; s < correspondences.size(); ++s) {
      if (correspondences[s].before < 0) continue;
      const auto o = static_cast<std::size_t>(correspondences[s].before);
      transfer(correspondences[s],
               from.subspan(before->offset(o), static_cast<std::size_t>(before->count(o))),
               usual(particles).subspan(offset(s), static_cast<std::size_t>(count(s))),
               to.subspan(offset(s), static_cast<std::size_t>(count(s))));
    }
  };
  if (is_same_kind && memory() == PatchMemory::kShared) {
    transfer_row(old.shared_belief, particles.shared_belief);
  }
  for (std::size_t i = 0; i < particles.size(); ++i) {
    RandomStream random(seed, StreamId::kPatchTransition, step, static_cast<std::uint32_t>(i));
    const bool had_submap = is_same_kind && old.submap[i] >= 0;
    draw(particles, i, random,
         had_submap ? successors[static_cast<std::size_t>(old.submap[i])] : -1);
    if (!is_same_kind) continue;
    if (memory() == PatchMemory::kPerParticle) {
      transfer_row(old.belief(i), particles.belief(i));
    } else if (memory() == PatchMemory::kNone && particles.submap[i] >= 0 &&
               old.configuration[i] >= 0) {
      const Correspondence& correspondence =
          correspondences[static_cast<std::size_t>(particles.submap[i])];
      if (correspondence.before != old.submap[i]) continue;
      particles.configuration[i] =
          successor(correspondence, static_cast<std::size_t>(old.configuration[i]), random);
    }
  }
}

}  // namespace strata::localization
