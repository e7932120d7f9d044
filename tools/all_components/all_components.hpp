// SPDX-License-Identifier: Apache-2.0
/// Every component that compositions can name.
#pragma once

#include "components/runtime/composition.hpp"
#include "components/runtime/registry.hpp"
#include "components/runtime/stand_in.hpp"

namespace strata::tools {

/// Adds each that strata_component() declares in CMake.
void register_components(runtime::Registry& registry);
/// Those that are linked in.
[[nodiscard]] runtime::Registry all_components();
/// Those and the ones of the composition's libraries; throws as load_component_libraries.
[[nodiscard]] runtime::Registry all_components(const runtime::Composition& composition);
/// The nodes of other projects that some of them stand in for.
[[nodiscard]] runtime::StandIns all_stand_ins();

}  // namespace strata::tools
