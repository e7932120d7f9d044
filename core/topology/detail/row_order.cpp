// SPDX-License-Identifier: Apache-2.0
#include "core/topology/detail/row_order.hpp"

#include <algorithm>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

namespace strata::topology::detail {
namespace {

/// Finding an order of rows takes as long as a factor; those of so many visits are put behind it
/// before another one is looked for.
constexpr std::size_t kOrderedVisits = 8;

/// Few fill-ins: minimum degree, by whole poses.
std::vector<int> ordered_rows(const Touching& pairs, std::size_t visits) {
  const auto size = static_cast<int>(visits) - 1;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(visits + 2 * pairs.size());
  for (int i = 0; i < size; ++i) entries.emplace_back(i, i, 1.0);
  for (const auto& [a, b] : pairs) {
    entries.emplace_back(static_cast<int>(a) - 1, static_cast<int>(b) - 1, 1.0);
    entries.emplace_back(static_cast<int>(b) - 1, static_cast<int>(a) - 1, 1.0);
  }
  Eigen::SparseMatrix<double> pattern(size, size);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern, order);
  std::vector<int> rows(visits, 0);
  for (int i = 0; i < size; ++i) rows[static_cast<std::size_t>(order.indices()[i]) + 1] = i;
  return rows;
}

}  // namespace

Touching touching(const Terms& terms, const LocationPriorConfig& config,
                  std::span<const Pose2> poses, NearPairs& near) {
  Touching pairs;
  pairs.reserve(terms.links.size() + terms.revisits.size());
  const auto touch = [&](std::size_t a, std::size_t b) {
    if (a > 0 && b > 0) pairs.emplace_back(a, b);
  };
  for (const Link& link : terms.links) touch(link.a, link.b);
  for (const Pair& pair : terms.revisits) touch(pair.a, pair.b);
  if (config.max_penalty > 0.0) {
    for (const Pair& pair : near.at(poses)) touch(pair.a, pair.b);
  }
  return pairs;
}

BlockPattern pattern_of(const Touching& pairs, const std::vector<int>& rows) {
  std::vector<std::pair<int, int>> touching_rows;
  touching_rows.reserve(pairs.size());
  for (const auto& [a, b] : pairs) {
    touching_rows.emplace_back(std::max(rows[a], rows[b]), std::min(rows[a], rows[b]));
  }
  return BlockPattern(static_cast<int>(rows.size()) - 1, touching_rows);
}

std::vector<int> rows_after(const LocationGaussian* before, const Touching& pairs,
                            std::size_t visits) {
  if (before == nullptr || before->rows().size() + 1 != visits || visits % kOrderedVisits == 0) {
    return ordered_rows(pairs, visits);
  }
  std::vector<int> rows = before->rows();
  rows.push_back(static_cast<int>(visits) - 2);
  return rows;
}

}  // namespace strata::topology::detail
