// SPDX-License-Identifier: Apache-2.0
/// Who may look: decides by what an HTTP request says of itself.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace strata::live_view {

inline constexpr std::string_view kMetricsPath = "/metrics";

/// Of a request's target: what stands before its query.
[[nodiscard]] inline std::string_view path_of(std::string_view target) {
  return target.substr(0, target.find('?'));
}

struct AccessRules {
  std::string token;                 ///< empty: none is needed
  std::vector<std::string> origins;  ///< of other hosts' pages that may connect without it
  bool is_secure = false;            ///< HTTPS: a page of this server comes from there
};

struct WebRequest {
  std::string_view method;
  std::string_view target;  ///< "/?token=..."
  std::string_view host;
  std::string_view origin;  ///< empty: not sent, as by programs that are no browsers
  std::string_view authorization;
};

struct Verdict {
  int status = 200;  ///< of HTTP
  std::string why;   ///< in words, unless it is 200
};

/// Only GET, and only "/" and kMetricsPath. With a token: by the query's `token` or "Authorization:
/// Bearer TOKEN", compared in a time that does not tell how much of it is right. Without: the Host
/// must be this machine by a loopback name, so that a foreign name that was made to point here (DNS
/// rebinding) is refused, and the Origin, where a browser sends it, must be that host or one of the
/// rules'.
[[nodiscard]] Verdict judge(const AccessRules& rules, const WebRequest& request);

}  // namespace strata::live_view
