// SPDX-License-Identifier: Apache-2.0
#include "core/patch/sequence_vectors.hpp"

#include <algorithm>
#include <cstdlib>

#include "core/beam_filter/beam_model.hpp"

namespace strata::patch {
namespace {
/// A surface this near may be the cell's own, displaced by the error of the poses.
constexpr int kUnsureCells = 3;
}  // namespace

ReflectionGrid filter_counts(const Grid<CellCounts>& counts, double prior, double min_evidence) {
  ReflectionGrid result = make_reflection_grid(counts.resolution_m(), counts.rect());
  for (std::size_t i = 0; i < counts.size(); ++i) {
    result.values()[i] =
        static_cast<float>(beam_filter::closed_form(counts.values()[i], prior, min_evidence));
  }
  return result;
}

std::vector<float> feature_vector(const ReflectionGrid& reflection, std::span<const Cell> cells) {
  std::vector<float> result;
  result.reserve(cells.size());
  for (const Cell& cell : cells) {
    float greatest = kUnknownReflection;
    bool is_unsure = false;
    for (int dy = -kUnsureCells; dy <= kUnsureCells; ++dy) {
      for (int dx = -kUnsureCells; dx <= kUnsureCells; ++dx) {
        const float m = reflection.get({cell.x + dx, cell.y + dy});
        if (std::abs(dx) > 1 || std::abs(dy) > 1) {
          is_unsure = is_unsure || (is_known(m) && m >= kMostlyOccupied);
          continue;
        }
        if (is_known(m)) greatest = is_known(greatest) ? std::max(greatest, m) : m;
        is_unsure = is_unsure || (!is_known(m) && (dx == 0 || dy == 0));
      }
    }
    const bool is_seen = !is_unsure || greatest >= kMostlyOccupied;
    result.push_back(is_seen ? std::min(1.0F, greatest / kMostlyOccupied) : kUnknownReflection);
  }
  return result;
}

}  // namespace strata::patch
