// SPDX-License-Identifier: Apache-2.0
/// What every node of ROS 2 answers to ~/get_type_description.
#pragma once

#include "strata_idl/type_description_interfaces.h"

namespace strata::convert {

/// The description of the type that is asked for, and its text when that is wanted too. Not
/// successful, with a reason, for a type we do not know and for another hash than ours; an empty
/// hash asks for the type whatever it is.
[[nodiscard]] type_description_interfaces::srv::GetTypeDescription_Response answer(
    const type_description_interfaces::srv::GetTypeDescription_Request& request);

}  // namespace strata::convert
