// SPDX-License-Identifier: Apache-2.0
/// The formulas of one beam and one cell: which part of a reading is due to something static.
#pragma once

#include <cmath>

#include "core/grid/counting_map.hpp"
#include "core/grid/reflection_grid.hpp"

namespace strata::beam_filter {

/// Probabilities are kept this far from 0 and 1 inside logarithms only, never in counts or maps.
inline constexpr double kLogMargin = 1e-3;

/// e = P(c = 1 | z, m) of a beam that ends in a cell of reflection probability m
/// [stachniss2003chapter] eq. (1.10), written p m / (p m + (1 - p)(1 - m)): equal to the printed
/// form, but defined at m = 0 (e = 0) as well. Both arguments in [0, 1]; prior in (0, 1).
[[nodiscard]] double expectation(double reflection, double prior);

/// One E-step and M-step of a cell [stachniss2003chapter] eqs. (1.10), (1.15):
/// m' = h e(m) / (h + f). counts: hits h and misses f with every beam taken as static (e = 1).
/// Requires a positive total.
[[nodiscard]] double em_step(double reflection, const CellCounts& counts_at_e1, double prior);

/// The limit of EM at fixed poses, where cells decouple: with r = h / (h + f), the log likelihood
/// is concave in m and has its maximum at clip((p r + p - 1) / (2 p - 1), 0, 1). NaN (unknown)
/// where the total is below min_evidence. Ours (docs/theory/beam_filter.md, "Closed form"); tests
/// compare it with thousands of EM steps. Requires prior > 0.5.
[[nodiscard]] double closed_form(const CellCounts& counts_at_e1, double prior, double min_evidence);

/// The reflection that judges a beam end in a cell: reflection_at(cell), or with `tolerant` the
/// greatest known one of the 3 x 3 around it. NaN when unknown.
template <typename ReflectionAt>
[[nodiscard]] auto judging_reflection(const Cell& end, bool tolerant,
                                      const ReflectionAt& reflection_at) {
  auto best = reflection_at(end);
  if (!tolerant) return best;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const auto value = reflection_at(Cell{end.x + dx, end.y + dy});
      if (value > best || std::isnan(best)) best = value;
    }
  }
  return best;
}

}  // namespace strata::beam_filter
