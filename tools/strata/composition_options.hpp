// SPDX-License-Identifier: Apache-2.0
/// A composition with what the command line says about it.
#pragma once

#include <memory>
#include <string>

#include "components/runtime/composition.hpp"
#include "components/runtime/host.hpp"
#include "tools/all_components/all_components.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// What --set and --config mean for the verbs that read a composition.
inline constexpr const char* kCompositionSetHelp =
    "COMPONENT.parameter=value, as localizer.maps=MAPS, or a key of the composition, as domain=7; "
    "may be repeated";
inline constexpr const char* kCompositionConfigHelp =
    "parameters as YAML: component names (version: 1), or a ROS 2 parameter file, nav2's too";

/// The file with --config and then --set applied.
[[nodiscard]] inline runtime::Composition load_composition(const std::string& file,
                                                           const CommonOptions& options) {
  return runtime::load_composition(file, options.overrides, options.config_file, all_stand_ins());
}

/// As above; tells the user what --config says that no component takes.
[[nodiscard]] inline runtime::Composition load_composition(const std::string& file,
                                                           VerbContext& context) {
  runtime::Composition composition = load_composition(file, context.options);
  for (const std::string& note : composition.notes) context.note("note: " + note);
  return composition;
}

/// Its participant; tells the user what is to be known of it.
[[nodiscard]] inline std::shared_ptr<bus::Participant> join(const runtime::Composition& composition,
                                                            VerbContext& context) {
  auto participant = runtime::make_participant(composition);
  for (const std::string& warning : participant->warnings()) context.note("warning: " + warning);
  return participant;
}

/// Prints what each process and component would do, and warns of what does not fit together.
void explain(const runtime::Composition& composition);

}  // namespace strata::tools
