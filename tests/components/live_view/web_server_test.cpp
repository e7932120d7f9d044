// SPDX-License-Identifier: Apache-2.0
/// What the server does with who is no viewer, or a bad one.
#include "components/live_view/web_server.hpp"

#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/live_view/page.hpp"
#include "core/base/error.hpp"
#include "tests/components/live_view/web_client.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::live_view {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class WebServerTest : public testing::Test {
 protected:
  std::shared_ptr<ViewHub> hub_ = std::make_shared<ViewHub>("strata", CommandNames{}, 2);
  std::unique_ptr<WebServer> server_ = make({});

  std::unique_ptr<WebServer> make(const AccessRules& rules) {
    const auto metrics = [](std::string_view accept) {
      return WebText{"text/of-metrics", "metrics for " + std::string(accept) + "\n"};
    };
    return std::make_unique<WebServer>(WebServerOptions{"127.0.0.1", 0, rules, page(), metrics},
                                       hub_, 2);
  }
  std::string get(const std::string& target, const std::string& more = "") {
    return test::exchange(server_->port(),
                          "GET " + target + " HTTP/1.1\r\nHost: localhost\r\n" + more + "\r\n");
  }
  /// Whether a viewer is served as ever.
  void expect_alive() {
    test::WebClient viewer;
    EXPECT_EQ(viewer.connect(server_->port()), 101);
    EXPECT_TRUE(viewer.read_op("serverInfo").has_value());
  }
};

TEST_F(WebServerTest, SendsThePageAndForbidsItToLoadAnythingElse) {
  const std::string answer = get("/");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(answer, HasSubstr("Content-Security-Policy: default-src 'none'"));
  EXPECT_EQ(answer.substr(answer.find("\r\n\r\n") + 4), page());
  EXPECT_EQ(page().find("https://"), std::string_view::npos) << "it works offline";
}

TEST_F(WebServerTest, AnswersMetricsInTheFormThatIsAskedFor) {
  const std::string answer = get("/metrics", "Accept: a/b\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(answer, HasSubstr("Content-Type: text/of-metrics\r\n"));
  EXPECT_EQ(answer.substr(answer.find("\r\n\r\n") + 4), "metrics for a/b\n");
  server_ =
      std::make_unique<WebServer>(WebServerOptions{"127.0.0.1", 0, {}, page(), nullptr}, hub_, 2);
  EXPECT_THAT(get("/metrics"), StartsWith("HTTP/1.1 404"));
}

TEST_F(WebServerTest, OutlivesThoseWhoSendNothingOrNeverEnd) {
  // More than are served at a time, each with a request that does not end.
  boost::asio::io_context io;
  std::vector<test::tcp::socket> slow;
  const test::tcp::endpoint place(boost::asio::ip::make_address("127.0.0.1"), server_->port());
  boost::system::error_code error;
  for (int i = 0; i < 200; ++i) {
    slow.emplace_back(io).connect(place, error);
    if (i % 2 == 0) {
      boost::asio::write(slow.back(), boost::asio::buffer(std::string("GET / HT")), error);
    }
  }
  // They keep their places for as long as a request may take, and no longer.
  std::string answer;
  ASSERT_TRUE(test::comes_true([&] {
    answer = get("/");
    return answer.starts_with("HTTP/1.1 200");
  }));
  expect_alive();
}

TEST_F(WebServerTest, OutlivesThousandsWhoComeAndGo) {
  boost::asio::io_context io;
  const test::tcp::endpoint place(boost::asio::ip::make_address("127.0.0.1"), server_->port());
  boost::system::error_code error;
  for (int i = 0; i < 3000; ++i) {
    test::tcp::socket socket(io);
    socket.connect(place, error);
    if (i % 3 != 0) {
      const std::string request = "GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n";
      boost::asio::write(socket, boost::asio::buffer(request), error);
    }
  }
  ASSERT_TRUE(test::comes_true([&] { return get("/metrics").starts_with("HTTP/1.1 200"); }));
  expect_alive();
}

TEST_F(WebServerTest, RefusesWhatIsNotThere) {
  EXPECT_THAT(get("/../../../etc/passwd"), StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(get("/", "Origin: https://evil.example\r\n"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(test::exchange(server_->port(), "POST / HTTP/1.1\r\nHost: localhost\r\n\r\n"),
              StartsWith("HTTP/1.1 405"));
  EXPECT_THAT(test::exchange(server_->port(), "nonsense\r\n\r\n"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(get("/metrics", "X: " + std::string(5 << 20, 'x') + "\r\n"),
              testing::Not(HasSubstr("200")));
  EXPECT_THAT(get("/", "X: " + std::string(100000, 'x') + "\r\n"), testing::Not(HasSubstr("200")));
  expect_alive();
}

TEST_F(WebServerTest, ChoosesASubprotocolThatBothKnow) {
  const auto connect = [&](const std::string& offered) {
    test::WebClient viewer;
    test::Greeting greeting;
    greeting.subprotocols = offered;
    const int status = viewer.connect(server_->port(), greeting);
    return std::to_string(status) + " " + viewer.subprotocol();
  };
  EXPECT_EQ(connect("foxglove.websocket.v1"), "101 foxglove.websocket.v1");
  EXPECT_EQ(connect("foxglove.websocket.v1, foxglove.sdk.v1"), "101 foxglove.sdk.v1");
  EXPECT_EQ(connect("mqtt"), "0 ");
  EXPECT_EQ(connect(""), "0 ");
}

TEST_F(WebServerTest, WantsTheTokenOfViewersToo) {
  server_ = make({"0123456789abcdef", {}});
  test::Greeting greeting;
  EXPECT_EQ(test::WebClient().connect(server_->port(), greeting), 0);
  greeting.target = "/?token=0123456789abcdeg";
  EXPECT_EQ(test::WebClient().connect(server_->port(), greeting), 0);
  greeting.target = "/?token=0123456789abcdef";
  EXPECT_EQ(test::WebClient().connect(server_->port(), greeting), 101);
  EXPECT_THAT(get("/"), StartsWith("HTTP/1.1 401"));
  EXPECT_THAT(get("/?token=0123456789abcdef"), StartsWith("HTTP/1.1 200"));
}

TEST_F(WebServerTest, RefusesOneViewerTooManyAndServesHimWhenOneHasLeft) {
  auto first = std::make_unique<test::WebClient>();
  test::WebClient second;
  first->connect(server_->port());
  second.connect(server_->port());
  ASSERT_TRUE(first->read_op("serverInfo").has_value());
  ASSERT_TRUE(second.read_op("serverInfo").has_value());
  test::WebClient third;
  third.connect(server_->port());
  EXPECT_FALSE(third.read().has_value());
  first.reset();
  ASSERT_TRUE(test::comes_true([&] { return hub_->counts().viewers == 1; }));
  expect_alive();
}

TEST_F(WebServerTest, EndsAConnectionThatSendsAMessageTooLong) {
  test::WebClient viewer;
  viewer.connect(server_->port());
  ASSERT_TRUE(viewer.read_op("serverInfo").has_value());
  EXPECT_NO_THROW(viewer.send_binary(std::string(200 << 10, 'x')));
  EXPECT_TRUE(viewer.read_op("status").has_value()) << "long, and no message";
  try {
    viewer.send_binary(std::string(300 << 10, 'x'));
  } catch (const boost::system::system_error&) {
  }
  EXPECT_FALSE(viewer.read().has_value());
  expect_alive();
}

TEST_F(WebServerTest, LivesThroughMutatedConnections) {
  const std::string upgrade =
      "GET / HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
      "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
      "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n\r\n";
  // A masked text frame, one with a length of 2^62 and a ping.
  const std::string frames = std::string("\x81\x82\0\0\0\0{}", 8) +
                             std::string("\x82\xff\x40\0\0\0\0\0\0\0\0\0\0\0", 14) +
                             std::string("\x89\x80\0\0\0\0", 6);
  std::mt19937 random(1);
  const auto below = [&](std::size_t bound) { return random() % bound; };
  for (int i = 0; i < 400; ++i) {
    // In every other one the greeting is good.
    std::string head = upgrade;
    std::string rest = frames;
    std::string& bytes = i % 2 == 0 ? rest : head;
    for (std::size_t n = below(4); n > 0; --n) {
      const std::size_t at = below(bytes.size());
      if (below(2) == 0) {
        bytes[at] = static_cast<char>(below(256));
      } else {
        bytes.erase(at, 1 + below(8));
      }
    }
    (void)test::exchange(server_->port(), head + rest);
  }
  ASSERT_TRUE(test::comes_true([&] { return hub_->counts().viewers == 0; }));
  expect_alive();
}

TEST_F(WebServerTest, SaysWhenItsPortIsTaken) {
  try {
    const WebServer second({"127.0.0.1", server_->port(), {}, page(), nullptr}, hub_, 2);
    FAIL() << "took a port that is taken";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr(std::to_string(server_->port())));
    EXPECT_THAT(error.what(), HasSubstr("taken by another program"));
  }
  EXPECT_THROW(WebServer({"nowhere", 0, {}, page(), nullptr}, hub_, 2), ConfigError);
}

}  // namespace
}  // namespace strata::live_view
