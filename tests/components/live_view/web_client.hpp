// SPDX-License-Identifier: Apache-2.0
/// A viewer: connects, asks, and reads what comes, each within a minute.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <nlohmann/json.hpp>

namespace strata::test {

namespace beast = boost::beast;
namespace websocket = beast::websocket;
using tcp = boost::asio::ip::tcp;

struct Received {
  bool is_binary = false;
  std::string bytes;
};

struct Greeting {
  std::string target = "/";
  std::string host = "localhost";
  std::string origin;  ///< empty: not sent
  std::string subprotocols = "foxglove.websocket.v1";
};

class WebClient {
 public:
  WebClient() : stream_(io_) {}

  /// HTTP's status, 101, when it is connected; 0 when it was refused.
  int connect(std::uint16_t port, const Greeting& greeting = {}) {
    beast::get_lowest_layer(stream_).connect(
        tcp::endpoint(boost::asio::ip::make_address("127.0.0.1"), port));
    stream_.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
      if (!greeting.subprotocols.empty()) {
        request.set(beast::http::field::sec_websocket_protocol, greeting.subprotocols);
      }
      if (!greeting.origin.empty()) request.set(beast::http::field::origin, greeting.origin);
    }));
    stream_.read_message_max(256U << 20U);
    websocket::response_type response;
    beast::error_code error;
    stream_.handshake(response, greeting.host, greeting.target, error);
    if (error) return 0;
    chosen_ = std::string(response[beast::http::field::sec_websocket_protocol]);
    return static_cast<int>(response.result_int());
  }
  [[nodiscard]] const std::string& subprotocol() const { return chosen_; }

  void send(const nlohmann::json& message) {
    stream_.text(true);
    stream_.write(boost::asio::buffer(message.dump()));
  }
  void send_binary(const std::string& bytes) {
    stream_.binary(true);
    stream_.write(boost::asio::buffer(bytes));
  }
  /// None: nothing came within a minute, or the server ended the connection.
  std::optional<Received> read() {
    std::optional<beast::error_code> result;
    beast::flat_buffer buffer;
    beast::get_lowest_layer(stream_).expires_after(std::chrono::seconds(60));
    stream_.async_read(buffer, [&](beast::error_code error, std::size_t) { result = error; });
    io_.restart();
    io_.run();
    beast::get_lowest_layer(stream_).expires_never();
    if (!result || *result) return std::nullopt;
    return Received{stream_.got_binary(), beast::buffers_to_string(buffer.data())};
  }
  /// The first that is wanted; others are passed over.
  std::optional<nlohmann::json> read_json(
      const std::function<bool(const nlohmann::json&)>& wanted) {
    while (const auto received = read()) {
      if (received->is_binary) continue;
      nlohmann::json json = nlohmann::json::parse(received->bytes);
      if (wanted(json)) return json;
    }
    return std::nullopt;
  }
  std::optional<nlohmann::json> read_op(const std::string& op) {
    return read_json([&](const nlohmann::json& json) { return json.at("op") == op; });
  }
  /// Reads until that topic was advertised; its channel.
  std::optional<nlohmann::json> channel_of(const std::string& topic) {
    while (!channels_.contains(topic)) {
      const auto advertised = read_op("advertise");
      if (!advertised) return std::nullopt;
      for (const auto& channel : advertised->at("channels")) {
        channels_[channel.at("topic")] = channel;
      }
    }
    return channels_.at(topic);
  }
  /// Whether the topic is there to subscribe to.
  bool subscribe(std::uint32_t id, const std::string& topic) {
    const auto channel = channel_of(topic);
    if (!channel) return false;
    send(
        {{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", channel->at("id")}}}}});
    return true;
  }
  /// The CDR bytes of the next message of that subscription.
  std::optional<std::vector<std::uint8_t>> message_of(std::uint32_t id) {
    constexpr std::size_t kHead = 13;
    while (const auto received = read()) {
      if (!received->is_binary || received->bytes.size() < kHead || received->bytes[0] != 1 ||
          static_cast<std::uint8_t>(received->bytes[1]) != id) {
        continue;
      }
      return std::vector<std::uint8_t>(received->bytes.begin() + kHead, received->bytes.end());
    }
    return std::nullopt;
  }

 private:
  boost::asio::io_context io_;
  websocket::stream<beast::tcp_stream> stream_;
  std::string chosen_;
  std::map<std::string, nlohmann::json> channels_;
};

/// Sends these bytes on a new connection and returns all that comes until the server ends it; the
/// client ends its side at once.
inline std::string exchange(std::uint16_t port, const std::string& bytes) {
  boost::asio::io_context io;
  tcp::socket socket(io);
  socket.connect(tcp::endpoint(boost::asio::ip::make_address("127.0.0.1"), port));
  boost::system::error_code error;
  boost::asio::write(socket, boost::asio::buffer(bytes), error);
  socket.shutdown(tcp::socket::shutdown_send, error);
  std::string answer;
  boost::asio::read(socket, boost::asio::dynamic_buffer(answer), error);
  return answer;
}

}  // namespace strata::test
