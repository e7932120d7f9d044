// SPDX-License-Identifier: Apache-2.0
/// The formulas of one beam and one cell: which part of a reading is due to something static.
#pragma once

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

/// (1 - p) / p: cells hit by at most this share of their beams become free.
[[nodiscard]] double critical_ratio(double prior);

/// ln p(z | c, x, m) of [stachniss2003chapter] eq. (1.1) with beams weighted by length,
/// (1 - m)^l: unknown cells say nothing. The end cell of a ray without a hit says nothing if the
/// ray stands for a maximum range reading of the paper; here such a ray stands for free space up to
/// its end, so the end cell counts like the others. [nats]. O(cells the ray crosses).
[[nodiscard]] double log_beam_likelihood(const Ray& ray, bool is_static, const ReflectionGrid& map);

}  // namespace strata::beam_filter
