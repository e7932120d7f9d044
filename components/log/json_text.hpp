// SPDX-License-Identifier: Apache-2.0
/// JSON as text, whatever files, frames and topics are called.
#pragma once

#include <string>

namespace strata::log {

/// Indented by two, with a line end. Names may have any bytes: what is no UTF-8 becomes U+FFFD,
/// where nlohmann::json would throw. O(size).
template <typename Json>
[[nodiscard]] std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace strata::log
