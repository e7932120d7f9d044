// SPDX-License-Identifier: Apache-2.0
/// Reads the IDL that is built in, for what is made of it: definitions for viewers, layouts,
/// hashes, packages for ROS 2.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "components/convert/message_definitions.hpp"

namespace strata::convert {

/// A struct of idl/.
struct IdlDefinition {
  std::string kind;               ///< "msg" or "srv", the module it stands in
  std::string text;               ///< as in a .msg file, a line a field
  std::string commented_text;     ///< the same with the comments of the IDL
  std::vector<std::string> uses;  ///< other structs, "std_msgs/Header"
  MessageLayout layout;
};
/// By "std_msgs/Header"; a service is two of them, "std_srvs/Empty_Request" and "_Response".
using IdlDefinitions = std::map<std::string, IdlDefinition>;

/// All of idl/, read once. Lives as long as the program.
[[nodiscard]] const IdlDefinitions& idl_definitions();

/// Adds what a file defines. Knows the subset of IDL that idl/ keeps to: modules, structs of
/// scalars, strings, arrays, sequences (bounded or not) and other structs, and enums (uint32 on the
/// wire, as DDS has them). O(text).
void read_idl(std::string_view idl, IdlDefinitions& definitions);

}  // namespace strata::convert
