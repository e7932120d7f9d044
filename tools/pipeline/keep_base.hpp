// SPDX-License-Identifier: Apache-2.0
/// For learn.cpp alone.
#pragma once

#include "core/slam/slam.hpp"
#include "tools/pipeline/learn_within.hpp"

namespace strata::pipeline {

/// Throws InputError where the maps before have cells of another size than those to be learned.
void require_same_cells(const LearnWithin& limits, double resolution_m);

/// Puts back what the grid maps were in cells where nothing is learned, and blinds the beams of
/// runs from first_run on that say something of them. O(cells + beams of those runs x cells they
/// cross).
void keep_base(const LearnWithin& limits, int first_run, slam::SlamResult& slam);

}  // namespace strata::pipeline
