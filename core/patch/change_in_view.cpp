// SPDX-License-Identifier: Apache-2.0
#include "core/patch/change_in_view.hpp"

#include <algorithm>

namespace strata::patch {
namespace {

constexpr double kSameChange_s = 1.0;
constexpr std::size_t kLeastCells = 6;

}  // namespace

std::vector<std::uint32_t> changes_in_view(const VisitTable& table, std::span<const Cell> cells,
                                           std::span<const PosedScan> scans,
                                           std::uint32_t first_scan, double gap_s) {
  const auto at = [&](std::uint32_t scan) -> const PosedScan& { return scans[scan - first_scan]; };
  const auto seconds_between = [&](std::uint32_t a, std::uint32_t b) {
    return (at(b).scan.stamp - at(a).scan.stamp).seconds();
  };
  std::vector<std::uint32_t> cuts;
  for (const Cell& cell : cells) {
    const auto visits = table.at(cell);
    for (std::size_t v = 1; v < visits.size(); ++v) {
      const std::uint32_t before = visits[v - 1].last_scan;
      const std::uint32_t after = visits[v].first_scan;
      if (before < first_scan || after < before || after - first_scan >= scans.size()) continue;
      if (at(before).run != at(after).run) continue;
      if (seconds_between(before, after) <= gap_s) cuts.push_back(after);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  std::vector<std::uint32_t> changes;
  for (std::size_t begin = 0; begin < cuts.size();) {
    std::size_t end = begin + 1;
    while (end < cuts.size() && at(cuts[end]).run == at(cuts[begin]).run &&
           seconds_between(cuts[end - 1], cuts[end]) <= kSameChange_s) {
      ++end;
    }
    if (end - begin >= kLeastCells) changes.push_back(cuts[begin + (end - begin) / 2]);
    begin = end;
  }
  return changes;
}

std::vector<Sequence> cut_at(const Sequence& sequence, std::span<const std::uint32_t> changes,
                             int min_scans) {
  std::vector<Sequence> parts;
  const auto least = static_cast<std::ptrdiff_t>(min_scans);
  auto begin = sequence.scans.begin();
  const auto keep = [&](std::vector<std::uint32_t>::const_iterator end) {
    if (end - begin >= least) parts.push_back({{begin, end}});
    begin = end;
  };
  for (const std::uint32_t change : changes) {
    keep(std::lower_bound(begin, sequence.scans.end(), change));
  }
  keep(sequence.scans.end());
  if (parts.empty()) parts.push_back(sequence);
  return parts;
}

}  // namespace strata::patch
