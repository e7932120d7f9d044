// SPDX-License-Identifier: Apache-2.0
/// A robot that publishes over DDS, and viewers of it.
#include "components/live_view/live_view.hpp"

#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/site_service_types.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/live_view/register.hpp"
#include "components/runtime/diagnostics.hpp"
#include "tests/components/live_view/metric_reader.hpp"
#include "tests/components/live_view/web_client.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::live_view {
namespace {

using geometry_msgs::msg::PoseWithCovarianceStamped;
using sensor_msgs::msg::LaserScan;

class LiveViewTest : public testing::Test {
 protected:
  std::shared_ptr<bus::Participant> robot_ = test::make_participant();
  bus::Writer<nav_msgs::msg::OccupancyGrid> maps_{robot_, std::string("/map"),
                                                  bus::qos_profile("latched")};
  bus::Writer<LaserScan> scans_{robot_, std::string("/scan"), bus::qos_profile("sensor_data")};
  std::unique_ptr<runtime::Host> host_ = make();
  std::jthread ticks_;

  ~LiveViewTest() override {
    ticks_ = {};
    host_->stop();
    EXPECT_THAT(host_->take_errors(), testing::IsEmpty());
  }
  void SetUp() override {
    host_->activate();
    ticks_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        host_->tick();
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
    });
  }
  static std::unique_ptr<runtime::Host> make(const std::string& more = "") {
    runtime::Registry registry;
    register_component(registry);
    return test::make_host(
        "{type: strata::LiveView, name: view, parameters: {port: 0" + more + "}}", registry,
        test::make_participant());
  }
  /// As /diagnostics tells it.
  std::uint16_t port() {
    test::Collector<diagnostic_msgs::msg::DiagnosticArray> told(test::make_participant(),
                                                                "/diagnostics", "default");
    std::uint16_t found = 0;
    std::size_t wanted = 1;
    EXPECT_TRUE(test::comes_true([&] {
      for (const auto& array : told.wait_for(wanted++)) {
        for (const auto& status : array.status()) {
          for (const auto& value : status.values()) {
            if (value.key() != "url") continue;
            found = static_cast<std::uint16_t>(
                std::stoi(value.value().substr(value.value().rfind(':') + 1)));
          }
        }
      }
      return found != 0;
    }));
    return found;
  }
  static LaserScan scan(int number) {
    LaserScan made;
    made.header(convert::make_header(Stamp{number * 100'000'000LL}, "laser"));
    made.range_max(30.0F);
    made.ranges(std::vector<float>(1080, static_cast<float>(number)));
    return made;
  }
  static nav_msgs::msg::OccupancyGrid map() {
    nav_msgs::msg::OccupancyGrid made;
    made.header(convert::make_header(Stamp{1}, "map"));
    made.info().resolution(0.05F);
    made.info().width(400);
    made.info().height(300);
    made.data().assign(400 * 300, 0);
    for (std::size_t i = 0; i < 400; ++i) made.data()[i] = 100;
    return made;
  }
};

TEST_F(LiveViewTest, GivesTwoViewersTheMapAndScansBitForBit) {
  maps_.publish(map());
  const std::uint16_t at = port();
  test::WebClient first;
  test::WebClient second;
  for (test::WebClient* viewer : {&first, &second}) {
    ASSERT_EQ(viewer->connect(at), 101);
    ASSERT_TRUE(viewer->subscribe(1, "/map"));
    ASSERT_TRUE(viewer->subscribe(2, "/scan"));
    EXPECT_EQ(viewer->message_of(1), convert::to_cdr(map()));
  }
  ASSERT_TRUE(scans_.raw().wait_for_readers(1, std::chrono::seconds(20)));
  for (int i = 1; i < 4; ++i) {
    scans_.publish(scan(i));
    for (test::WebClient* viewer : {&first, &second}) {
      EXPECT_EQ(viewer->message_of(2), convert::to_cdr(scan(i))) << i;
    }
  }
}

TEST_F(LiveViewTest, AnswersMetricsOfEveryComponentOnTheDomain) {
  runtime::Diagnostics other(robot_, "/robot/localizer");
  const std::uint16_t at = port();
  const std::string wanted = "strata_localization_score{component=\"/robot/localizer\"}";
  std::map<std::string, double> samples;
  EXPECT_TRUE(test::comes_true([&] {
    runtime::Health health;
    health.add("localizationScore", 0.75);
    other.publish(health, Stamp{1});
    const std::string answer = test::exchange(
        at,
        "GET /metrics HTTP/1.1\r\nHost: localhost\r\nAccept: application/openmetrics-text\r\n\r\n");
    EXPECT_THAT(answer, testing::HasSubstr("application/openmetrics-text; version=1.0.0"));
    samples = test::MetricReader(true).read(answer.substr(answer.find("\r\n\r\n") + 4)).samples;
    return samples.contains(wanted) && samples.contains("strata_view_viewers{component=\"/view\"}");
  }));
  EXPECT_EQ(samples[wanted], 0.75);
  EXPECT_EQ(samples["strata_component_active{component=\"/view\"}"], 1.0);
}

TEST_F(LiveViewTest, ReadsNothingThatNoViewerWants) {
  test::WebClient viewer;
  ASSERT_EQ(viewer.connect(port()), 101);
  ASSERT_TRUE(viewer.subscribe(1, "/map"));
  maps_.publish(map());
  ASSERT_TRUE(viewer.message_of(1).has_value());
  EXPECT_EQ(scans_.raw().matched(), 0);
}

TEST_F(LiveViewTest, IsNotHeldUpByAViewerThatDoesNotRead) {
  // Reliable, and the scans are large: more than the system would hold for him.
  bus::Writer<LaserScan> reliable(robot_, std::string("/large"), bus::qos_profile("default"));
  const std::uint16_t at = port();
  test::WebClient slow;
  test::WebClient quick;
  ASSERT_EQ(slow.connect(at), 101);
  ASSERT_EQ(quick.connect(at), 101);
  ASSERT_TRUE(slow.subscribe(1, "/large"));
  ASSERT_TRUE(quick.subscribe(1, "/large"));
  ASSERT_TRUE(reliable.raw().wait_for_readers(1, std::chrono::seconds(20)));
  const runtime::Component& component = *host_->components().front();
  for (int i = 0; i < 1000; ++i) {
    LaserScan large = scan(i);
    large.ranges().resize(20'000);
    reliable.publish(large);
    // Waits for the one who reads, so that nothing but the slow one can be left behind.
    ASSERT_TRUE(quick.message_of(1).has_value()) << i;
  }
  EXPECT_EQ(component.counts().dropped, 0U);
  EXPECT_GE(component.counts().processed, 1000U);
  // When he reads again he has the newest, after what the system held.
  LaserScan last = scan(1000);
  reliable.publish(last);
  bool has_come = false;
  int read = 0;
  while (!has_come) {
    const auto message = slow.message_of(1);
    ASSERT_TRUE(message.has_value());
    has_come = *message == convert::to_cdr(last);
    ++read;
  }
  EXPECT_LT(read, 900) << "older ones were left out";
}

TEST_F(LiveViewTest, PublishesThePoseThatAViewerGives) {
  test::Collector<PoseWithCovarianceStamped> poses(robot_, "/initialpose", "default");
  test::WebClient viewer;
  ASSERT_EQ(viewer.connect(port()), 101);
  ASSERT_TRUE(poses.wait_for_writer());
  viewer.send({{"op", "advertise"},
               {"channels",
                {{{"id", 1},
                  {"topic", "/initialpose"},
                  {"encoding", "cdr"},
                  {"schemaName", "geometry_msgs/msg/PoseWithCovarianceStamped"}}}}});
  PoseWithCovarianceStamped pose;
  pose.header(convert::make_header(Stamp{5}, "map"));
  pose.pose().pose().position().x(3.5);
  const auto cdr = convert::to_cdr(pose);
  viewer.send_binary(std::string("\1\1\0\0\0", 5) + std::string(cdr.begin(), cdr.end()));
  const auto found = poses.wait_for(1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0], pose);
}

TEST_F(LiveViewTest, SaysThatNobodyAnswersACall) {
  test::WebClient viewer;
  ASSERT_EQ(viewer.connect(port()), 101);
  viewer.send_binary(std::string("\2\1\0\0\0\5\0\0\0\3\0\0\0cdr\0\1\0\0\0", 21));
  const auto failure = viewer.read_op("serviceCallFailure");
  ASSERT_TRUE(failure.has_value());
  EXPECT_THAT(failure->at("message").get<std::string>(),
              testing::HasSubstr("/reinitialize_global_localization"));
}

TEST_F(LiveViewTest, AsksTheLocalizerToSearchEverywhere) {
  std::atomic<int> asked{0};
  const auto mailbox = std::make_shared<runtime::Mailbox>();
  runtime::ServiceHub services(robot_, mailbox, [](const std::exception&) {});
  services.serve<bus::srv::Empty>("/reinitialize_global_localization", "default", [&](const auto&) {
    ++asked;
    return std_srvs::srv::Empty_Response();
  });
  test::WebClient viewer;
  ASSERT_EQ(viewer.connect(port()), 101);
  viewer.send_binary(std::string("\2\1\0\0\0\5\0\0\0\3\0\0\0cdr\0\1\0\0\0", 21));
  std::optional<test::Received> answer;
  do {
    answer = viewer.read();
    ASSERT_TRUE(answer.has_value());
  } while (!answer->is_binary);
  EXPECT_EQ(answer->bytes[0], 3);
  EXPECT_EQ(asked, 1);
}

TEST_F(LiveViewTest, HasTheMapperSaveAndTellsWhatItSays) {
  std::atomic<bool> is_full{false};
  const auto mailbox = std::make_shared<runtime::Mailbox>();
  runtime::ServiceHub services(robot_, mailbox, [](const std::exception&) {});
  services.serve<bus::srv::Trigger>("/scan_matcher/save", "default", [&](const auto&) {
    std_srvs::srv::Trigger_Response response;
    response.success(!is_full);
    response.message(is_full ? "the disk is full" : "saved in maps");
    return response;
  });
  test::WebClient viewer;
  ASSERT_EQ(viewer.connect(port()), 101);
  const std::string call("\2\2\0\0\0\5\0\0\0\3\0\0\0cdr\0\1\0\0\0", 21);
  viewer.send_binary(call);
  std::optional<test::Received> answer;
  do {
    answer = viewer.read();
    ASSERT_TRUE(answer.has_value());
  } while (!answer->is_binary);
  EXPECT_EQ(answer->bytes.substr(0, 9), std::string("\3\2\0\0\0\5\0\0\0", 9));
  EXPECT_THAT(answer->bytes, testing::HasSubstr("saved in maps"));
  is_full = true;
  viewer.send_binary(call);
  const auto failure = viewer.read_op("serviceCallFailure");
  ASSERT_TRUE(failure.has_value());
  EXPECT_EQ(failure->at("serviceId"), 2);
  EXPECT_THAT(failure->at("message").get<std::string>(), testing::HasSubstr("the disk is full"));
}

TEST_F(LiveViewTest, HasAVersionActivatedWhereAComponentTellsOfItsSiteAndTellsARefusal) {
  std::atomic<bool> is_approved{true};
  std::string asked;
  const auto mailbox = std::make_shared<runtime::Mailbox>();
  runtime::ServiceHub services(robot_, mailbox, [](const std::exception&) {});
  services.serve<bus::srv::ActivateSiteVersion>(
      "/hall/localizer/activate_version", "default", [&](const auto& request) {
        asked = request.version() + " by " + request.by();
        strata_msgs::srv::ActivateSiteVersion_Response response;
        response.success(is_approved);
        response.message(is_approved ? "version 2 is active" : "version 2: was not approved");
        return response;
      });
  const bus::Writer<strata_msgs::msg::SiteVersions> told(
      robot_, std::string("/hall/localizer/site_versions"), bus::qos_profile("latched"));
  test::WebClient viewer;
  ASSERT_EQ(viewer.connect(port()), 101);
  bool is_offered = false;
  while (!is_offered) {
    const auto offer = viewer.read_op("advertiseServices");
    ASSERT_TRUE(offer.has_value());
    for (const auto& service : offer->at("services")) {
      is_offered = is_offered || service.at("name") == "/hall/localizer/activate_version";
    }
  }
  strata_msgs::srv::ActivateSiteVersion_Request request;
  request.version("2");
  request.by("ada");
  const auto cdr = convert::to_cdr(request);
  const std::string call =
      std::string("\2\4\0\0\0\5\0\0\0\3\0\0\0cdr", 16) + std::string(cdr.begin(), cdr.end());
  viewer.send_binary(call);
  std::optional<test::Received> answer;
  do {
    answer = viewer.read();
    ASSERT_TRUE(answer.has_value());
  } while (!answer->is_binary);
  EXPECT_THAT(answer->bytes, testing::HasSubstr("version 2 is active"));
  EXPECT_EQ(asked, "2 by ada");
  is_approved = false;
  viewer.send_binary(call);
  const auto failure = viewer.read_op("serviceCallFailure");
  ASSERT_TRUE(failure.has_value());
  EXPECT_EQ(failure->at("message"), "version 2: was not approved");
  viewer.send_binary(call.substr(0, 20));
  const auto broken = viewer.read_op("serviceCallFailure");
  ASSERT_TRUE(broken.has_value()) << "a request that does not decode is answered, too";
  EXPECT_THAT(broken->at("message").get<std::string>(),
              testing::HasSubstr("a viewer's /hall/localizer/activate_version"));
}

TEST(LiveViewSettings, WantATokenAndTlsForOtherMachines) {
  runtime::Registry registry;
  register_component(registry);
  const auto configure = [&](const std::string& parameters) {
    const auto host = test::make_host(
        "{type: strata::LiveView, name: view, parameters: {port: 0, " + parameters + "}}", registry,
        test::make_participant());
    host->activate();
    host->stop();
  };
  EXPECT_THROW(configure("address: 0.0.0.0"), ConfigError);
  EXPECT_THROW(configure("address: 0.0.0.0, token: short"), ConfigError);
  EXPECT_THROW(configure("address: 0.0.0.0, token: 0123456789abcdef"), ConfigError)
      << "without TLS who listens has the token";
  EXPECT_THROW(configure("address: 0.0.0.0, certificate: a.crt, private_key: a.key"), ConfigError);
  EXPECT_THROW(configure("certificate: a.crt"), ConfigError);
  EXPECT_THROW(configure("certificate: a.crt, private_key: a.key"), ConfigError) << "no files";
  EXPECT_NO_THROW(configure("address: 127.0.0.1, token: 0123456789abcdef"));
}

}  // namespace
}  // namespace strata::live_view
