// SPDX-License-Identifier: Apache-2.0
#include "core/patch/learn_again.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/base/time.hpp"
#include "core/patch/patch_learner.hpp"

namespace strata::patch {
namespace {

/// Of the scans that a sub-map was learned from, enough to learn it again.
constexpr double kEnough = 0.5;

std::vector<Stamp> stamps_of(std::span<const PosedScan> scans) {
  std::vector<Stamp> stamps;
  stamps.reserve(scans.size());
  for (const PosedScan& scan : scans) stamps.push_back(scan.scan.stamp);
  std::sort(stamps.begin(), stamps.end());
  return stamps;
}

/// Whether most of the scans of its sequences are there. Runs may have other numbers by now.
bool can_be_learned(const Submap& submap, const std::vector<Stamp>& stamps) {
  double of_all = 0.0;
  double there = 0.0;
  for (const SequenceInfo& sequence : submap.sequences) {
    const auto first = std::lower_bound(stamps.begin(), stamps.end(), sequence.begin);
    const auto last = std::upper_bound(stamps.begin(), stamps.end(), sequence.end);
    const auto within = static_cast<double>(std::max<std::ptrdiff_t>(0, last - first));
    const auto count = static_cast<double>(sequence.scans);
    of_all += count;
    there += std::min(count, within);
  }
  return of_all > 0.0 && there >= kEnough * of_all;
}

}  // namespace

ReflectionGrid filled(const ReflectionGrid& newer, const ReflectionGrid& older) {
  if (newer.resolution_m() != older.resolution_m()) return newer;
  ReflectionGrid both =
      make_reflection_grid(newer.resolution_m(), newer.rect().united(older.rect()));
  for (std::size_t i = 0; i < both.size(); ++i) {
    const Cell cell = both.cell(i);
    const float value = newer.get(cell);
    both.values()[i] = is_known(value) ? value : older.get(cell);
  }
  return both;
}

LearnedAgain learn_again(const PatchMap& before, std::span<const PosedScan> scans,
                         const ReflectionGrid& filtered, const PatchLearnerConfig& config,
                         Progress* progress) {
  PatchLearner learner(config);
  for (const PosedScan& scan : scans) learner.add(scan);
  LearnedAgain again{learner.finish(filtered, progress), 0};
  if (before.base.resolution_m() != filtered.resolution_m()) return again;
  const std::vector<Stamp> stamps = stamps_of(scans);
  std::vector<Submap> submaps;
  for (const Submap& submap : before.submaps) {
    if (!can_be_learned(submap, stamps)) submaps.push_back(submap);
  }
  again.stayed = submaps.size();
  if (again.stayed == 0) return again;
  for (Submap& fresh : again.map.submaps) {
    const auto stays_there = [&](const Submap& old) {
      return !old.rect.intersected(fresh.rect).empty();
    };
    const auto end = submaps.begin() + static_cast<std::ptrdiff_t>(again.stayed);
    if (std::none_of(submaps.begin(), end, stays_there)) submaps.push_back(std::move(fresh));
  }
  for (std::size_t i = 0; i < submaps.size(); ++i) submaps[i].id = static_cast<int>(i);
  again.map.submaps = std::move(submaps);
  again.map.base = filled(filtered, before.base);
  return again;
}

}  // namespace strata::patch
