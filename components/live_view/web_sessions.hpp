// SPDX-License-Identifier: Apache-2.0
/// Connections of browsers and viewers, each answered on the server's thread.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>

#include "components/live_view/view_hub.hpp"
#include "components/live_view/web_access.hpp"
#include "components/live_view/web_text.hpp"

namespace strata::live_view {

/// What every connection uses.
struct WebShared {
  std::shared_ptr<ViewHub> hub;
  AccessRules rules;
  std::string_view page;
  MetricsSource metrics;
  std::size_t connections = 0;
  std::optional<boost::asio::ssl::context> tls;  ///< nothing: plain HTTP
  boost::asio::io_context io{1};  ///< last: the connections that end with it use the others
};

/// Reads one HTTP request of a connection and answers it with the page, the metrics or in words; a
/// WebSocket is a viewer of the hub from then on. The connection counts while it lives. shared:
/// lives longer. On the thread that runs shared.io.
void serve(boost::asio::ip::tcp::socket socket, WebShared& shared);

}  // namespace strata::live_view
