// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/all_components.hpp"

#include "components/beam_filter/register.hpp"
#include "components/localizer/amcl_parameters.hpp"
#include "components/localizer/register.hpp"
#include "components/map_saver/nav2_parameters.hpp"
#include "components/map_saver/register.hpp"
#include "components/map_server/nav2_parameters.hpp"
#include "components/map_server/register.hpp"
#include "components/patch_learner/register.hpp"
#include "components/player/register.hpp"
#include "components/recorder/register.hpp"
#include "components/runtime/component_library.hpp"
#include "components/scan_matcher/register.hpp"
#include "components/timescale_memory/register.hpp"
#include "components/topology_mapper/register.hpp"
#include "components/volume_mapper/register.hpp"

namespace strata::tools {

runtime::Registry all_components() {
  runtime::Registry registry;
  scan_matcher::register_component(registry);
  beam_filter::register_component(registry);
  patch_learner::register_component(registry);
  localizer::register_component(registry);
  timescale_memory::register_component(registry);
  map_saver::register_component(registry);
  map_server::register_component(registry);
  topology_mapper::register_component(registry);
  volume_mapper::register_component(registry);
  player::register_component(registry);
  recorder::register_component(registry);
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
