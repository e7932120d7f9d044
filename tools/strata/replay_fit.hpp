// SPDX-License-Identifier: Apache-2.0
/// Whether the maps of a replay's localizers explain the log.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "components/runtime/composition.hpp"
#include "tools/pipeline/runs_input.hpp"

namespace strata::tools {

/// A warning for each localizer of the composition whose maps do not explain the log, from what it
/// saved below `out`. Where its maps came over topics, its score alone is asked. Throws InputError.
[[nodiscard]] std::vector<std::string> fit_warnings(const std::filesystem::path& out,
                                                    const runtime::Composition& composition,
                                                    const pipeline::Runs& runs);

}  // namespace strata::tools
