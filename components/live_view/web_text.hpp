// SPDX-License-Identifier: Apache-2.0
/// What is answered in words.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace strata::live_view {

struct WebText {
  std::string content_type;
  std::string text;
};

/// Makes the answer to a request for metrics with that Accept header. Called on the server's
/// thread.
using MetricsSource = std::function<WebText(std::string_view accept)>;

}  // namespace strata::live_view
