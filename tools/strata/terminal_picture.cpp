// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/terminal_picture.hpp"

#include <iostream>

#include "tools/report/terminal_shape.hpp"

namespace strata::tools {

void show_map(const ReflectionGrid& map, std::span<const report::TerminalWay> ways,
              VerbContext& context) {
  if (context.options.quiet) return;
  const auto shape = report::shape_for(report::facts_of_stdout());
  if (!shape) return;
  context.clear_progress();
  std::cout << report::terminal_map(map, ways, *shape) << std::flush;
}

}  // namespace strata::tools
