// SPDX-License-Identifier: Apache-2.0
/// The figures of a comparison's report, one function a section.
#pragma once

#include "tools/pipeline/compare.hpp"
#include "tools/report/html_report.hpp"

namespace strata::pipeline {

/// Over time with the changes met, histogram, shares, against bytes.
void add_errors(const Comparison& comparison, report::HtmlReport& page);
/// Raw and filtered with a slider, dynamic beams, the trace of EM.
void add_maps(const LearnResult& learned, report::HtmlReport& page);
/// Every sub-map with its configurations.
void add_patches(const LearnResult& learned, report::HtmlReport& page);
/// The posterior of the sub-map that tells most; nothing when no model has any.
void add_states(const Comparison& comparison, report::HtmlReport& page);
/// Levels of a node, and each level's map.
void add_timescale(const LearnResult& learned, const maps::Maps& maps, report::HtmlReport& page);

}  // namespace strata::pipeline
