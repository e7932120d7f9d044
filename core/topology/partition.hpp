// SPDX-License-Identifier: Apache-2.0
/// Topologies as set partitions of landmark visits [ranganathan2006rao, section II].
#pragma once

#include <cstddef>
#include <vector>

namespace strata::topology {

/// Which landmark each visit belongs to: a restricted growth string, labels numbered by first
/// appearance, so that two equal topologies are equal vectors.
using Labels = std::vector<int>;

/// The same partition with labels numbered by first appearance. Any integers may come in. O(n).
[[nodiscard]] Labels canonical(const Labels& labels);
/// Whether labels are numbered by first appearance, from 0.
[[nodiscard]] bool is_canonical(const Labels& labels);
/// Distinct landmarks of a canonical sequence: 0 for none. O(n).
[[nodiscard]] int landmark_count(const Labels& labels);
/// Index of the first visit of every landmark, by label. Requires canonical labels. O(n).
[[nodiscard]] std::vector<std::size_t> first_visits(const Labels& labels);

}  // namespace strata::topology
