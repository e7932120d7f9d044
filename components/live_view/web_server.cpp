// SPDX-License-Identifier: Apache-2.0
// The only file that knows Boost.Beast. Everything but construction runs on the server's thread.
#include "components/live_view/web_server.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "components/live_view/foxglove_texts.hpp"
#include "core/base/error.hpp"

namespace strata::live_view {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using boost::system::error_code;

constexpr std::size_t kMaxHeaderBytes = 8192;
constexpr std::size_t kMaxMessageBytes = 256U << 10U;
constexpr auto kRequestPatience = std::chrono::seconds(10);
/// Beside the viewers': for pages that load.
constexpr std::size_t kOtherConnections = 64;
/// What the system holds for a viewer beside its hub's queue; more would only be stale.
constexpr int kSendBufferBytes = 512 << 10;

/// What every connection uses.
struct Shared {
  std::shared_ptr<ViewHub> hub;
  AccessRules rules;
  std::string_view page;
  std::size_t connections = 0;
  asio::io_context io{1};  ///< last: the connections that end with it use the others
};

/// Counts a connection while it lives.
class Connection {
 public:
  explicit Connection(Shared& shared) : shared_(&shared) { ++shared.connections; }
  ~Connection() { --shared_->connections; }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

 private:
  Shared* shared_;
};

using Request = http::request<http::empty_body>;

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

/// The first of ours that the viewer offers; empty: none.
std::string subprotocol_of(const Request& request) {
  const http::token_list offered(request[http::field::sec_websocket_protocol]);
  for (const char* const ours : kSubprotocols) {
    for (const auto token : offered) {
      if (token == ours) return ours;
    }
  }
  return "";
}

/// One viewer: reads what it asks, writes what the hub has for it, one message at a time.
class ViewerSession : public std::enable_shared_from_this<ViewerSession> {
 public:
  ViewerSession(beast::tcp_stream stream, Shared& shared, std::unique_ptr<Connection> connection)
      : shared_(shared), connection_(std::move(connection)), stream_(std::move(stream)) {}
  ~ViewerSession() {
    if (viewer_) shared_.hub->leave(*viewer_);
  }
  ViewerSession(const ViewerSession&) = delete;
  ViewerSession& operator=(const ViewerSession&) = delete;

  void accept(const Request& request, const std::string& subprotocol) {
    beast::get_lowest_layer(stream_).expires_never();
    stream_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    stream_.set_option(websocket::stream_base::decorator([subprotocol](auto& response) {
      response.set(http::field::sec_websocket_protocol, subprotocol);
    }));
    stream_.read_message_max(kMaxMessageBytes);
    stream_.write_buffer_bytes(kMaxHeaderBytes);
    stream_.auto_fragment(false);
    stream_.async_accept(request, [self = shared_from_this()](error_code error) {
      if (!error) self->begin();
    });
  }

 private:
  void begin() {
    const std::weak_ptr<ViewerSession> weak = weak_from_this();
    viewer_ = shared_.hub->join([weak, &io = shared_.io] {
      asio::post(io, [weak] {
        if (const auto self = weak.lock()) self->write();
      });
    });
    if (!viewer_) {
      stream_.async_close({websocket::close_code::try_again_later, "too many viewers"},
                          [self = shared_from_this()](error_code) {});
      return;
    }
    read();
  }
  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->end();
      const auto bytes = self->buffer_.cdata();
      self->shared_.hub->take(*self->viewer_, self->stream_.got_binary(),
                              {static_cast<const char*>(bytes.data()), bytes.size()});
      self->buffer_.consume(bytes.size());
      self->read();
    });
  }
  void write() {
    if (is_writing_ || has_ended_) return;
    auto frame = shared_.hub->next(*viewer_);
    if (!frame) return;
    frame_ = std::move(*frame);
    is_writing_ = true;
    const std::array<asio::const_buffer, 2> parts{
        asio::buffer(frame_.head),
        frame_.message ? asio::buffer(frame_.message->cdr) : asio::const_buffer()};
    stream_.binary(frame_.is_binary);
    stream_.async_write(parts, [self = shared_from_this()](error_code error, std::size_t) {
      self->is_writing_ = false;
      self->frame_ = {};
      if (error) return self->end();
      self->write();
    });
  }
  void end() {
    has_ended_ = true;
    beast::get_lowest_layer(stream_).close();
  }

  Shared& shared_;
  std::unique_ptr<Connection> connection_;
  websocket::stream<beast::tcp_stream> stream_;
  beast::flat_buffer buffer_;
  std::optional<ViewerId> viewer_;
  Frame frame_;
  bool is_writing_ = false;
  bool has_ended_ = false;
};

/// One request: answered with the page or in words, or a viewer from then on.
class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(tcp::socket socket, Shared& shared)
      : shared_(shared),
        connection_(std::make_unique<Connection>(shared)),
        stream_(std::move(socket)) {}

  void run() {
    stream_.expires_after(kRequestPatience);
    parser_.header_limit(kMaxHeaderBytes);
    parser_.body_limit(0);
    http::async_read_header(stream_, buffer_, parser_,
                            [self = shared_from_this()](error_code error, std::size_t) {
                              if (!error) return self->answer();
                              if (error.category() == http::make_error_code({}).category() &&
                                  error != http::error::end_of_stream) {
                                self->send(400, "that is no HTTP request");
                              }
                            });
  }

 private:
  void answer() {
    const Request& request = parser_.get();
    const Verdict verdict = judge(
        shared_.rules, {view_of(request.method_string()), view_of(request.target()),
                        view_of(request[http::field::host]), view_of(request[http::field::origin]),
                        view_of(request[http::field::authorization])});
    if (verdict.status != 200) return send(verdict.status, verdict.why);
    if (!websocket::is_upgrade(request)) return send_page();
    const std::string subprotocol = subprotocol_of(request);
    if (subprotocol.empty()) {
      return send(400, std::string("offer the subprotocol ") + kSubprotocols[0] + " or " +
                           kSubprotocols[1]);
    }
    std::make_shared<ViewerSession>(std::move(stream_), shared_, std::move(connection_))
        ->accept(request, subprotocol);
  }
  void send(int status, const std::string& text) {
    make_response(status, "text/plain; charset=utf-8");
    response_.body() = text + "\n";
    write();
  }
  void send_page() {
    make_response(200, "text/html; charset=utf-8");
    // Nothing but what the page holds itself runs, and it talks to nobody but this server.
    response_.set("Content-Security-Policy",
                  "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
                  "img-src data:; connect-src 'self' ws: wss:; base-uri 'none'; "
                  "form-action 'none'; frame-ancestors 'none'");
    response_.body() = std::string(shared_.page);
    write();
  }
  void make_response(int status, const char* type) {
    response_.version(11);
    response_.result(static_cast<unsigned>(status));
    response_.set(http::field::content_type, type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    response_.keep_alive(false);
  }
  void write() {
    response_.prepare_payload();
    stream_.expires_after(kRequestPatience);
    http::async_write(stream_, response_, [self = shared_from_this()](error_code, std::size_t) {
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  Shared& shared_;
  std::unique_ptr<Connection> connection_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{2 * kMaxHeaderBytes};
  http::request_parser<http::empty_body> parser_;
  http::response<http::string_body> response_;
};

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
    shared.rules = options.rules;
    shared.page = options.page;
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
        std::make_shared<HttpSession>(std::move(socket), shared)->run();
      }
      accept();
    });
  }
  void work() {
    // What one connection throws, as for want of memory, ends that connection only.
    for (;;) {
      try {
        shared.io.run();
        return;
      } catch (const std::exception&) {
        ++caught;
      }
    }
  }

  Shared shared;
  std::size_t max_connections;
  tcp::acceptor acceptor{shared.io};
  asio::steady_timer pause{shared.io};
  std::atomic<std::uint64_t> caught{0};
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
  return "http://" + (endpoint.address().is_v6() ? "[" + address + "]" : address) + ":" +
         std::to_string(endpoint.port()) + "/";
}

}  // namespace strata::live_view
