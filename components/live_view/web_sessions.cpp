// SPDX-License-Identifier: Apache-2.0
// The only file that knows Boost.Beast.
#include "components/live_view/web_sessions.hpp"

#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>

#include "components/live_view/foxglove_texts.hpp"

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

using PlainStream = beast::tcp_stream;
using TlsStream = beast::ssl_stream<beast::tcp_stream>;

/// Counts a connection while it lives.
class Connection {
 public:
  explicit Connection(WebShared& shared) : shared_(&shared) { ++shared.connections; }
  ~Connection() { --shared_->connections; }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

 private:
  WebShared* shared_;
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
template <class Stream>
class ViewerSession : public std::enable_shared_from_this<ViewerSession<Stream>> {
 public:
  ViewerSession(Stream stream, WebShared& shared, std::unique_ptr<Connection> connection)
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
    stream_.async_accept(request, [self = this->shared_from_this()](error_code error) {
      if (!error) self->begin();
    });
  }

 private:
  void begin() {
    const std::weak_ptr<ViewerSession> weak = this->weak_from_this();
    viewer_ = shared_.hub->join([weak, &io = shared_.io] {
      asio::post(io, [weak] {
        if (const auto self = weak.lock()) self->write();
      });
    });
    if (!viewer_) {
      stream_.async_close({websocket::close_code::try_again_later, "too many viewers"},
                          [self = this->shared_from_this()](error_code) {});
      return;
    }
    read();
  }
  void read() {
    stream_.async_read(buffer_, [self = this->shared_from_this()](error_code error, std::size_t) {
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
    stream_.async_write(parts, [self = this->shared_from_this()](error_code error, std::size_t) {
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

  WebShared& shared_;
  std::unique_ptr<Connection> connection_;
  websocket::stream<Stream> stream_;
  beast::flat_buffer buffer_;
  std::optional<ViewerId> viewer_;
  Frame frame_;
  bool is_writing_ = false;
  bool has_ended_ = false;
};

/// One request: answered with the page or in words, or a viewer from then on.
template <class Stream>
class HttpSession : public std::enable_shared_from_this<HttpSession<Stream>> {
 public:
  HttpSession(Stream stream, WebShared& shared)
      : shared_(shared),
        connection_(std::make_unique<Connection>(shared)),
        stream_(std::move(stream)) {}

  void run() {
    beast::get_lowest_layer(stream_).expires_after(kRequestPatience);
    if constexpr (std::is_same_v<Stream, TlsStream>) {
      // Who speaks plain HTTP here, or knows no TLS 1.2, is not answered.
      stream_.async_handshake(asio::ssl::stream_base::server,
                              [self = this->shared_from_this()](error_code error) {
                                if (!error) self->read();
                              });
    } else {
      read();
    }
  }

 private:
  void read() {
    parser_.header_limit(kMaxHeaderBytes);
    parser_.body_limit(0);
    http::async_read_header(stream_, buffer_, parser_,
                            [self = this->shared_from_this()](error_code error, std::size_t) {
                              if (!error) return self->answer();
                              if (error.category() == http::make_error_code({}).category() &&
                                  error != http::error::end_of_stream) {
                                self->send(400, "that is no HTTP request");
                              }
                            });
  }
  void answer() {
    const Request& request = parser_.get();
    const Verdict verdict = judge(
        shared_.rules, {view_of(request.method_string()), view_of(request.target()),
                        view_of(request[http::field::host]), view_of(request[http::field::origin]),
                        view_of(request[http::field::authorization])});
    if (verdict.status != 200) return send(verdict.status, verdict.why);
    if (path_of(view_of(request.target())) == kMetricsPath) return send_metrics();
    if (!websocket::is_upgrade(request)) return send_page();
    const std::string subprotocol = subprotocol_of(request);
    if (subprotocol.empty()) {
      return send(400, std::string("offer the subprotocol ") + kSubprotocols[0] + " or " +
                           kSubprotocols[1]);
    }
    std::make_shared<ViewerSession<Stream>>(std::move(stream_), shared_, std::move(connection_))
        ->accept(request, subprotocol);
  }
  void send(int status, const std::string& text) {
    make_response(status, "text/plain; charset=utf-8");
    response_.body() = text + "\n";
    write();
  }
  void send_metrics() {
    if (!shared_.metrics) return send(404, "there are no metrics here");
    const WebText made = shared_.metrics(view_of(parser_.get()[http::field::accept]));
    make_response(200, made.content_type);
    response_.body() = made.text;
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
  void make_response(int status, const std::string& type) {
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
    beast::get_lowest_layer(stream_).expires_after(kRequestPatience);
    http::async_write(
        stream_, response_,
        [self = this->shared_from_this()](error_code, std::size_t) { self->close(); });
  }
  /// Says that nothing more comes.
  void close() {
    if constexpr (std::is_same_v<Stream, TlsStream>) {
      stream_.async_shutdown([self = this->shared_from_this()](error_code) {});
    } else {
      error_code ignored;
      stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    }
  }

  WebShared& shared_;
  std::unique_ptr<Connection> connection_;
  Stream stream_;
  beast::flat_buffer buffer_{2 * kMaxHeaderBytes};
  http::request_parser<http::empty_body> parser_;
  http::response<http::string_body> response_;
};

}  // namespace

void serve(tcp::socket socket, WebShared& shared) {
  if (shared.tls) {
    TlsStream stream(std::move(socket), *shared.tls);
    std::make_shared<HttpSession<TlsStream>>(std::move(stream), shared)->run();
  } else {
    std::make_shared<HttpSession<PlainStream>>(PlainStream(std::move(socket)), shared)->run();
  }
}

}  // namespace strata::live_view
