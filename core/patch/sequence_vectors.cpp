// SPDX-License-Identifier: Apache-2.0
#include "core/patch/sequence_vectors.hpp"

#include <algorithm>

#include "core/beam_filter/beam_model.hpp"

namespace strata::patch {
namespace {
constexpr float kSurface = 0.5F;
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
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const float m = reflection.get({cell.x + dx, cell.y + dy});
        if (is_known(m)) greatest = is_known(greatest) ? std::max(greatest, m) : m;
      }
    }
    // A cell in the shadow of an object is next to free cells; it is not free itself.
    const bool is_seen = is_known(reflection.get(cell)) || greatest >= kSurface;
    result.push_back(is_seen ? std::min(1.0F, greatest / kSurface) : kUnknownReflection);
  }
  return result;
}

}  // namespace strata::patch
