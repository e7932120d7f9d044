// SPDX-License-Identifier: Apache-2.0
/// Other projects' localizers in a comparison.
#pragma once

#include <string>
#include <vector>

#include "tools/pipeline/compare.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// Those that were built beside this program. Throws ConfigError when there are none. Their files
/// lie beside `out` while they run.
[[nodiscard]] std::vector<pipeline::Peer> peers_of_this_build(VerbContext& context,
                                                              const std::string& out);

}  // namespace strata::tools
