// SPDX-License-Identifier: Apache-2.0
/// One comparison of several: of splits, of buildings, of some seeds each.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/pipeline/comparison.hpp"

namespace strata::pipeline {

/// Adds the runs and scores of drives; their parts count from first_part on. Sizes, curves and
/// traces, which belong to one map, stay.
void append_drives(const ModelResult& from, std::size_t first_part, ModelResult& to);

/// The splits of one comparison, in their order, with the same models: sizes and traces are those
/// of the first, points of the memory curves have the runs of all. Requires at least one.
[[nodiscard]] Comparison join_splits(std::vector<Comparison> splits);

/// The same split with different seeds, one of them with the scores: everything is that one's, and
/// the runs are all, by part and seed. Throws InputError when the parts or models differ, a seed is
/// there twice or none has the scores; `place` names them in it.
[[nodiscard]] Comparison join_seeds(std::vector<Comparison> shares, const std::string& place);

}  // namespace strata::pipeline
