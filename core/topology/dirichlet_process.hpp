// SPDX-License-Identifier: Apache-2.0
/// How likely the next visit is a known or a new landmark [ranganathan2006rao, eq. (5)].
#pragma once

#include <cstddef>
#include <vector>

#include "core/topology/partition.hpp"

namespace strata::topology {

/// Probability of every label of the next visit after `labels` (canonical): for known landmark j
/// n_j / (n - 1 + c), and last for a new one c / (n - 1 + c), where n counts the next visit too.
/// The printed denominator n + c does not sum to one; this one does. Requires concentration > 0.
/// O(n).
[[nodiscard]] std::vector<double> label_prior(const Labels& labels, double concentration);

/// Log probability of the whole sequence: the sum of its steps. O(n).
[[nodiscard]] double log_partition_prior(const Labels& labels, double concentration);

}  // namespace strata::topology
