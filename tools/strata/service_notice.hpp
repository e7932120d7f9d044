// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace strata::tools {

/// Sends a state ("READY=1", "STOPPING=1") to systemd, by the datagram protocol of sd_notify(3).
/// Does nothing where the program is no service of Type=notify. Returns whether it was sent.
bool tell_service_manager(std::string_view state);

}  // namespace strata::tools
