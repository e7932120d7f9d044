// SPDX-License-Identifier: Apache-2.0
/// Settings from outside a composition file: --set, --config, ROS 2 parameter files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "components/runtime/stand_in.hpp"

namespace strata::runtime {

/// The keys of a composition besides `version`.
[[nodiscard]] std::vector<std::string> composition_keys();

/// Key of a component entry that holds what is meant for all components.
inline constexpr const char* kCommonParameters = "common_parameters";

/// Key of a component entry that holds what is meant for the node that it stands in for.
inline constexpr const char* kStandInParameters = "stand_in_parameters";

/// "localizer.maps=M" sets a parameter of each component of that name, "domain=7" a key of the
/// composition. Throws ConfigError, with "did you mean" for a component that is not there.
void apply_composition_override(YAML::Node& document, const std::string& option);

/// A file of either form:
///
///     version: 1                    # keys of the composition, or components by name
///     domain: 7
///     localizer: {model: filtered}
///
///     /robot1/localizer:            # a ROS 2 parameter file: by full name, by name, or for all
///       ros__parameters: {model: filtered, localizer.particles: 500}
///     /*/matcher:                   # wildcards: see node_pattern.hpp
///       ros__parameters: {map_frame: floor}
///     /**:
///       ros__parameters: {map_frame: map}
///
/// More specific entries win, then later ones; of those that name no node ("/**", "/robot1/*") a
/// component takes what it knows. Entries for other nodes are left out: the result is what to tell
/// the user of them. Throws InputError, and ConfigError, also for parameters below no name, and for
/// a name that looks like a typo of a component's that has no entry of its own.
///
/// An entry that names "amcl" is for the component that stands in for amcl in that namespace, if
/// there is exactly one; it is kept in the component's entry for load_composition to translate. In
/// an entry for a component that is itself named "amcl", amcl's parameters are told from ours by
/// name.
std::vector<std::string> apply_composition_settings(YAML::Node& document,
                                                    const std::filesystem::path& file,
                                                    const StandIns& stand_ins = {});

}  // namespace strata::runtime
