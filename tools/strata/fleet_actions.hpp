// SPDX-License-Identifier: Apache-2.0
/// The actions of `strata fleet`, which programs built without PostgreSQL only refuse
/// (no_fleet.cpp).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/site/robot_check.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

struct FleetOptions {
  std::string url;
  std::string site;     ///< name on the server
  std::string folder;   ///< of a site, or of maps
  std::string against;  ///< folder of a site
  std::string frame = "map";
  std::string name;  ///< of a robot or an operator
  std::string version;
  std::string password_file;
  std::string by;
  std::string note;
  std::string why;
  std::vector<std::string> without;
  std::size_t keep_retired = 5;
  int timeout_s = 120;
  double spacing_m = 0.0;
  double tolerance_cells = 0.5;
  bool new_password = false;
  bool approve = false;
  bool activate = false;
  bool undo = false;
  bool again = false;
  bool unchecked = false;
  double max_contradicted = site::RobotLimits{}.max_contradicted;
  double max_above_others = site::RobotLimits{}.max_above_others;
  bool json = false;
};

/// Runs the action of that name.
void run_fleet_action(const std::string& name, const FleetOptions& options, VerbContext& context);

}  // namespace strata::tools
