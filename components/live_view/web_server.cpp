// SPDX-License-Identifier: Apache-2.0
// Everything but construction runs on the server's thread.
#include "components/live_view/web_server.hpp"

#include <chrono>
#include <fstream>
#include <string>
#include <thread>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/steady_timer.hpp>

#include "components/live_view/web_sessions.hpp"
#include "core/base/error.hpp"

namespace strata::live_view {
namespace {

namespace asio = boost::asio;
using tcp = asio::ip::tcp;
using boost::system::error_code;

/// Beside the viewers': for pages that load.
constexpr std::size_t kOtherConnections = 64;
/// What the system holds for a viewer beside its hub's queue; more would only be stale.
constexpr int kSendBufferBytes = 512 << 10;

tcp::endpoint endpoint_of(const WebServerOptions& options) {
  error_code error;
  const std::string address = options.address == "localhost" ? "127.0.0.1" : options.address;
  const auto parsed = asio::ip::make_address(address, error);
  if (error) {
    throw ConfigError("address", "'" + options.address + "' is no address",
                      "give one of this machine's, as 127.0.0.1 or 0.0.0.0 for all");
  }
  return {parsed, options.port};
}

/// TLS 1.2 or newer, and what goes with it as OpenSSL chooses.
asio::ssl::context tls_context(const TlsFiles& files) {
  asio::ssl::context context(asio::ssl::context::tls_server);
  SSL_CTX_set_min_proto_version(context.native_handle(), TLS1_2_VERSION);
  const auto require = [](const error_code& error, const char* key, const std::string& file) {
    if (!error) return;
    // OpenSSL's own codes have no text here.
    const bool is_readable = std::ifstream(file).good();
    throw ConfigError(
        key,
        file + (is_readable ? " is no PEM file of it, or not of this pair" : " cannot be read"),
        "give PEM files of a certificate and of its private key");
  };
  error_code error;
  context.use_certificate_chain_file(files.certificate, error);
  require(error, "certificate", files.certificate);
  // Which fails, too, for the key of another certificate.
  context.use_private_key_file(files.private_key, asio::ssl::context::pem, error);
  require(error, "private_key", files.private_key);
  return context;
}

}  // namespace

struct WebServer::State {
  State(const WebServerOptions& options, std::size_t max_viewers)
      : max_connections(max_viewers + kOtherConnections) {
    const tcp::endpoint endpoint = endpoint_of(options);
    error_code error;
    acceptor.open(endpoint.protocol(), error);
    if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor.bind(endpoint, error);
    if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (error) {
      const std::string place = options.address + ", port " + std::to_string(options.port);
      if (error == asio::error::address_in_use) {
        throw ConfigError("port", place + " is taken by another program",
                          "choose another port, or 0 for any that is free");
      }
      throw ConfigError("address", place + " cannot be used: " + error.message(),
                        "choose an address of this machine, and a port from 1024 on");
    }
    if (options.tls) shared.tls.emplace(tls_context(*options.tls));
    shared.rules = options.rules;
    shared.rules.is_secure = options.tls.has_value();
    shared.page = options.page;
    shared.metrics = options.metrics;
  }
  void accept() {
    acceptor.async_accept([this](error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (error) {
        // No more file descriptors, say: others may give some back.
        pause.expires_after(std::chrono::milliseconds(100));
        pause.async_wait([this](error_code ended) {
          if (!ended) accept();
        });
        return;
      }
      if (shared.connections < max_connections) {
        error_code ignored;
        socket.set_option(tcp::no_delay(true), ignored);
        socket.set_option(tcp::socket::send_buffer_size(kSendBufferBytes), ignored);
        serve(std::move(socket), shared);
      }
      accept();
    });
  }
  void work() {
    for (;;) {
      try {
        shared.io.run();
        return;
      } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): ends one connection only
      }
    }
  }

  WebShared shared;
  std::size_t max_connections;
  tcp::acceptor acceptor{shared.io};
  asio::steady_timer pause{shared.io};
  std::thread thread;
};

WebServer::WebServer(WebServerOptions options, std::shared_ptr<ViewHub> hub,
                     std::size_t max_viewers)
    : state_(std::make_unique<State>(options, max_viewers)) {
  state_->shared.hub = std::move(hub);
  state_->accept();
  state_->thread = std::thread([state = state_.get()] { state->work(); });
}

WebServer::~WebServer() {
  state_->shared.io.stop();
  state_->thread.join();
}

std::uint16_t WebServer::port() const { return state_->acceptor.local_endpoint().port(); }

std::string WebServer::url() const {
  const tcp::endpoint endpoint = state_->acceptor.local_endpoint();
  const std::string address = endpoint.address().to_string();
  return (state_->shared.tls ? "https://" : "http://") +
         (endpoint.address().is_v6() ? "[" + address + "]" : address) + ":" +
         std::to_string(endpoint.port()) + "/";
}

}  // namespace strata::live_view
