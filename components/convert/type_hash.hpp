// SPDX-License-Identifier: Apache-2.0
/// ROS 2's hash of a message or service type, by which two sides see before they talk whether they
/// mean the same by a name: SHA-256 of the type's description (REP 2016), from Iron on.
#pragma once

#include <string>
#include <string_view>

namespace strata::convert {

/// The description of a type ("std_msgs/msg/Header", "std_srvs/srv/Empty") and all that it
/// contains, as it is hashed: JSON with its keys and blanks just so. Empty for types we do not
/// know.
[[nodiscard]] std::string type_description(std::string_view type);

/// "RIHS01_" and 64 hex digits; empty for types we do not know. O(description).
[[nodiscard]] std::string type_hash(std::string_view type);

}  // namespace strata::convert
