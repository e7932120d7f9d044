// SPDX-License-Identifier: Apache-2.0
/// The page by HTTP and the hub's messages by WebSocket, on one port and a thread of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "components/live_view/view_hub.hpp"
#include "components/live_view/web_access.hpp"
#include "components/live_view/web_text.hpp"

namespace strata::live_view {

/// PEM files.
struct TlsFiles {
  std::string certificate;  ///< with those between it and its authority behind it
  std::string private_key;
};

struct WebServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  ///< 0: any that is free
  AccessRules rules;
  std::string_view page;                       ///< lives longer than the server
  MetricsSource metrics;                       ///< null: there are none
  std::optional<TlsFiles> tls = std::nullopt;  ///< nothing: plain HTTP
};

/// Serves the page, the metrics and viewers until it is destroyed. What is malformed, too long (8
/// kB of HTTP, 256 kB of a message) or slow (10 s for a request) ends that connection and nothing
/// else; so does a 65th connection beside max_viewers.
class WebServer {
 public:
  /// Throws ConfigError when the address is none, the port is taken, or certificate and key are
  /// none or of two pairs.
  WebServer(WebServerOptions options, std::shared_ptr<ViewHub> hub, std::size_t max_viewers);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  [[nodiscard]] std::uint16_t port() const;
  /// Without the token: "http://127.0.0.1:8765/", with TLS "https://...".
  [[nodiscard]] std::string url() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace strata::live_view
