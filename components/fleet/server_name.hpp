// SPDX-License-Identifier: Apache-2.0
// How messages name a server; connection.hpp has what others call.
#pragma once

#include <string>

namespace strata::fleet {

/// host: a name, or the folder of a socket; empty: this machine.
[[nodiscard]] std::string server_name(const std::string& host, const std::string& port,
                                      const std::string& database);

}  // namespace strata::fleet
