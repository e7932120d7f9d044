// SPDX-License-Identifier: Apache-2.0
/// The small map before the last line of learn, localize and compare.
#pragma once

#include <span>

#include "core/grid/reflection_grid.hpp"
#include "tools/report/terminal_map.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// Draws on stdout where that is a terminal that can show it (tools/report/terminal_shape.hpp), and
/// not with --quiet.
void show_map(const ReflectionGrid& map, std::span<const report::TerminalWay> ways,
              VerbContext& context);

}  // namespace strata::tools
