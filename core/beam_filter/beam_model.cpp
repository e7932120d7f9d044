// SPDX-License-Identifier: Apache-2.0
#include "core/beam_filter/beam_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace strata::beam_filter {

double expectation(double reflection, double prior) {
  const double by_static = prior * reflection;
  return by_static / (by_static + (1.0 - prior) * (1.0 - reflection));
}

double em_step(double reflection, const CellCounts& counts_at_e1, double prior) {
  return counts_at_e1.hits * expectation(reflection, prior) / counts_at_e1.total();
}

double closed_form(const CellCounts& counts_at_e1, double prior, double min_evidence) {
  // Written so that a NaN total is unknown too.
  if (!(counts_at_e1.total() >= min_evidence)) return std::numeric_limits<double>::quiet_NaN();
  const double ratio = counts_at_e1.hits / counts_at_e1.total();
  return std::clamp((prior * ratio + prior - 1.0) / (2.0 * prior - 1.0), 0.0, 1.0);
}

}  // namespace strata::beam_filter
