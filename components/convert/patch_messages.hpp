// SPDX-License-Identifier: Apache-2.0
/// The patch map on its latched topic.
#pragma once

#include <string>

#include "strata_idl/strata_msgs.h"

#include "core/base/time.hpp"
#include "core/patch/patch_map.hpp"

namespace strata::convert {

/// Bit for bit both ways. Reading throws InputError when grids and rectangles do not fit.
[[nodiscard]] strata_msgs::msg::PatchMap to_message(const patch::PatchMap& map, Stamp stamp,
                                                    const std::string& frame);
[[nodiscard]] patch::PatchMap from_message(const strata_msgs::msg::PatchMap& message);

}  // namespace strata::convert
