// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/warning.hpp"

#include <utility>

namespace strata::tools {

void warn(VerbContext& context, const std::string& line) {
  if (line.empty()) return;
  const bool quiet = std::exchange(context.options.quiet, false);
  context.note("warning: " + line);
  context.options.quiet = quiet;
}

}  // namespace strata::tools
