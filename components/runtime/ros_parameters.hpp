// SPDX-License-Identifier: Apache-2.0
/// ROS 2 parameter files, applied to a composition.
#pragma once

#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "components/runtime/stand_in.hpp"

namespace strata::runtime {

/// Whether a file has `ros__parameters` of any node. Throws ConfigError for those below no name.
[[nodiscard]] bool has_ros_parameters(const YAML::Node& file, const std::string& place);

/// Applies what the file has for the components of the document, as apply_composition_settings
/// says. file: with its own places. Returns what to tell the user.
[[nodiscard]] std::vector<std::string> apply_ros_parameters(YAML::Node& document,
                                                            const YAML::Node& file,
                                                            const std::string& place,
                                                            const StandIns& stand_ins);

}  // namespace strata::runtime
