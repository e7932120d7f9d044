// SPDX-License-Identifier: Apache-2.0
#include "components/live_view/web_access.hpp"

#include <algorithm>

#include "components/live_view/config.hpp"

namespace strata::live_view {
namespace {

bool is_same(std::string_view left, std::string_view right) {
  unsigned difference = left.size() == right.size() ? 0U : 1U;
  for (std::size_t i = 0; i < left.size() && !right.empty(); ++i) {
    difference |= static_cast<unsigned>(static_cast<unsigned char>(left[i]) ^
                                        static_cast<unsigned char>(right[i % right.size()]));
  }
  return difference == 0;
}

std::string_view token_in(std::string_view query) {
  constexpr std::string_view kKey = "token=";
  while (!query.empty()) {
    const std::string_view pair = query.substr(0, query.find('&'));
    if (pair.starts_with(kKey)) return pair.substr(kKey.size());
    query.remove_prefix(std::min(query.size(), pair.size() + 1));
  }
  return {};
}

std::string_view bearer_in(std::string_view authorization) {
  constexpr std::string_view kScheme = "Bearer ";
  return authorization.starts_with(kScheme) ? authorization.substr(kScheme.size())
                                            : std::string_view{};
}

/// Without the port: "localhost" of "localhost:8765", "::1" of "[::1]:8765".
std::string_view name_of(std::string_view host) {
  if (host.starts_with('[')) return host.substr(1, host.find(']') - 1);
  return host.substr(0, host.find(':'));
}

bool is_address_of_loopback(std::string_view name) {
  return is_loopback(name) &&
         (!name.starts_with("127.") || name.find_first_not_of("0123456789.") == name.npos);
}

}  // namespace

Verdict judge(const AccessRules& rules, const WebRequest& request) {
  if (request.method != "GET") return {405, "only GET is answered here"};
  const std::string_view path = path_of(request.target);
  if (path != "/" && path != kMetricsPath) return {404, "there is nothing but / and /metrics"};
  if (!rules.token.empty()) {
    const std::string_view query =
        request.target.substr(std::min(request.target.size(), path.size() + 1));
    if (is_same(token_in(query), rules.token) ||
        is_same(bearer_in(request.authorization), rules.token)) {
      return {};
    }
    return {401, "give the token, as in ?token=TOKEN"};
  }
  if (!is_address_of_loopback(name_of(request.host))) {
    return {403, "open it as localhost, or set a token"};
  }
  const std::string own = (rules.is_secure ? "https://" : "http://") + std::string(request.host);
  if (request.origin.empty() || request.origin == own ||
      std::find(rules.origins.begin(), rules.origins.end(), request.origin) !=
          rules.origins.end()) {
    return {};
  }
  return {403, "pages of other hosts may not connect without a token; or name them in origins"};
}

}  // namespace strata::live_view
