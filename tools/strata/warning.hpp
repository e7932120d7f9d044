// SPDX-License-Identifier: Apache-2.0
/// Warnings that --quiet does not silence.
#pragma once

#include <string>

#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// "warning: LINE" on stderr, also with --quiet: what makes a result worthless, or less than was
/// asked for. Nothing of an empty line.
void warn(VerbContext& context, const std::string& line);

}  // namespace strata::tools
