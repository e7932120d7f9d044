// SPDX-License-Identifier: Apache-2.0
/// Runs of the localizer over DDS, for a comparison: the maps from their folder, scans and odometry
/// over topics, and the answer off the topics, as a robot would see it.
#pragma once

#include "tools/pipeline/compare.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// Writes the maps of a split aside, beside `out`, and has strata::Localizer read them; each run is
/// a component of its own, one after the other, since they share /tf. Errors, estimates and states
/// are those of the direct path: positions bit for bit, headings as a quaternion carries them.
/// update_ms is what the component says on localization_health. Throws ConfigError for the model
/// `map`, which no MAPS folder holds.
[[nodiscard]] pipeline::MakeLocalize localize_over_dds(VerbContext& context,
                                                       const std::string& out);

}  // namespace strata::tools
