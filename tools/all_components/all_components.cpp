// SPDX-License-Identifier: Apache-2.0
#include "tools/all_components/all_components.hpp"

#include "components/localizer/amcl_parameters.hpp"
#include "components/map_saver/nav2_parameters.hpp"
#include "components/map_server/nav2_parameters.hpp"
#include "components/runtime/component_library.hpp"

namespace strata::tools {

runtime::Registry all_components() {
  runtime::Registry registry;
  register_components(registry);
  return registry;
}

runtime::Registry all_components(const runtime::Composition& composition) {
  runtime::Registry registry = all_components();
  runtime::load_component_libraries(composition, registry);
  return registry;
}

runtime::StandIns all_stand_ins() {
  return {localizer::amcl_stand_in(), map_server::nav2_stand_in(), map_saver::nav2_stand_in()};
}

}  // namespace strata::tools
