// SPDX-License-Identifier: Apache-2.0
/// A robot that publishes over DDS, and viewers of it.
#include "components/live_view/live_view.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/geometry_messages.hpp"
#include "components/live_view/register.hpp"
#include "components/runtime/diagnostics.hpp"
#include "tests/components/live_view/live_view_fixture.hpp"
#include "tests/components/live_view/metric_reader.hpp"
#include "tests/components/live_view/web_client.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/components/runtime/status_watch.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::live_view {
namespace {

using sensor_msgs::msg::LaserScan;

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
  // What is sent before both of them are served is lost.
  const std::vector<std::uint8_t> before = convert::to_cdr(scan(0));
  std::jthread sends([this](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      scans_.publish(scan(0));
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  for (test::WebClient* viewer : {&first, &second}) EXPECT_EQ(viewer->message_of(2), before);
  sends = {};
  for (int i = 1; i < 4; ++i) {
    scans_.publish(scan(i));
    for (test::WebClient* viewer : {&first, &second}) {
      auto received = viewer->message_of(2);
      while (received == before) received = viewer->message_of(2);
      EXPECT_EQ(received, convert::to_cdr(scan(i))) << i;
    }
  }
}

TEST_F(LiveViewTest, ReadsAWriterOfALatchedTopicThatComesLaterAndLatchesNothing) {
  maps_.publish(map());
  test::WebClient viewer;
  ASSERT_EQ(viewer.connect(port()), 101);
  ASSERT_TRUE(viewer.subscribe(1, "/map"));
  EXPECT_EQ(viewer.message_of(1), convert::to_cdr(map()));
  bus::Writer<nav_msgs::msg::OccupancyGrid> later(robot_, std::string("/map"),
                                                  bus::qos_profile("default"));
  ASSERT_TRUE(later.raw().wait_for_readers(1, std::chrono::seconds(20)));
  auto other = map();
  other.data()[5] = 50;
  later.publish(other);
  EXPECT_EQ(viewer.message_of(1), convert::to_cdr(other));
  other.data()[5] = 60;
  maps_.publish(other);
  EXPECT_EQ(viewer.message_of(1), convert::to_cdr(other));
  other.data()[5] = 70;
  later.publish(other);
  EXPECT_EQ(viewer.message_of(1), convert::to_cdr(other)) << "each once";
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

TEST(LiveViewTopics, AreReadThoughOneOfThemCannotBe) {
  const auto robot = test::make_participant();
  const auto own = test::make_participant();
  const auto other = bus::qos_profile("default");
  const bus::Reader<LaserScan> odd_too(own, "/a_odd", other, [](auto) {});  // with another type
  const bus::RawWriter odd(robot, "/a_odd", "std_msgs/msg/String", other);
  const bus::RawWriter scans(robot, "/scan", bus::MessageType<LaserScan>::name, other);
  ASSERT_TRUE(test::comes_true([&] {
    const auto topics = own->published_topics();
    return topics.contains("/a_odd") && topics.contains("/scan");
  }));
  runtime::Registry registry;
  register_component(registry);
  const auto host = test::make_host(
      "{type: strata::LiveView, name: view, parameters: {port: 0, keep_newest: true}}", registry,
      own);
  host->activate();
  EXPECT_TRUE(test::comes_true([&] {
    host->tick();
    return scans.wait_for_readers(1, std::chrono::milliseconds(0));
  }));
  EXPECT_EQ(host->components().front()->counts().skipped, 0U) << "no failure of its own";
  host->stop();
  EXPECT_THAT(host->take_errors(), testing::ElementsAre(testing::HasSubstr("cannot read /a_odd")));
}

/// A live view that ticks when it is looked at.
class LiveViewOfMonths : public testing::Test {
 protected:
  void begin(const std::string& parameters) {
    runtime::Registry registry;
    register_component(registry);
    host_ = test::make_host(
        "{type: strata::LiveView, name: view, parameters: {port: 0, " + parameters + "}}", registry,
        own_);
    host_->activate();
  }
  [[nodiscard]] std::unique_ptr<bus::RawWriter> writer(const std::string& topic,
                                                       const char* type) const {
    return std::make_unique<bus::RawWriter>(robot_, topic, type, bus::qos_profile("default"));
  }
  bool comes_true(const std::function<bool()>& condition) {
    return test::comes_true([&] {
      host_->tick();
      return condition();
    });
  }
  [[nodiscard]] bool is_published(const std::string& topic, const std::string& type) const {
    const auto topics = own_->published_topics();
    const auto found = topics.find(topic);
    return found != topics.end() && found->second.type == type;
  }

  std::shared_ptr<bus::Participant> robot_ = test::make_participant();
  std::shared_ptr<bus::Participant> own_ = test::make_participant();
  std::unique_ptr<runtime::Host> host_;
};

TEST_F(LiveViewOfMonths, GivesBackATopicThatNobodyPublishesAndTakesItsNameWithAnotherType) {
  const char* const scan = bus::MessageType<LaserScan>::name;
  const char* const map = bus::MessageType<nav_msgs::msg::OccupancyGrid>::name;
  begin("forget_after_s: 0.0, metrics: false, keep_newest: false");
  const auto told = test::StatusWatch(robot_).wait_for(
      *host_, [](const auto& now) { return !test::value_of(now, "url").empty(); });
  const std::string url = test::value_of(told, "url");
  const auto at = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
  const auto is_read_by_a_new_viewer = [&](const bus::RawWriter& of) {
    test::WebClient viewer;
    EXPECT_EQ(viewer.connect(at), 101);
    EXPECT_TRUE(viewer.subscribe(1, "/comes"));
    return comes_true([&] { return of.matched() == 1; });
  };
  auto scans = writer("/comes", scan);
  ASSERT_TRUE(comes_true([&] { return is_published("/comes", scan); }));
  ASSERT_TRUE(comes_true([&] { return is_read_by_a_new_viewer(*scans); }));
  scans.reset();
  const auto reads = [&] {
    const auto endpoints = own_->view().endpoints;
    return std::any_of(endpoints.begin(), endpoints.end(), [](const auto& endpoint) {
      return !endpoint.writes && endpoint.wire_topic == "rt/comes";
    });
  };
  EXPECT_TRUE(comes_true([&] { return !reads(); }));
  const auto maps = writer("/comes", map);
  ASSERT_TRUE(comes_true([&] { return is_published("/comes", map); }));
  EXPECT_TRUE(is_read_by_a_new_viewer(*maps)) << "the name is free again";
  host_->stop();
  EXPECT_THAT(host_->take_errors(), testing::IsEmpty());
}

TEST_F(LiveViewOfMonths, LeavesOutMoreTopicsThanItMayHaveAndMakesRoomOfThoseThatAreGone) {
  begin("keep_newest: true, max_topics: 6, metrics: false");
  std::vector<std::unique_ptr<bus::RawWriter>> writers;
  for (int i = 0; i < 12; ++i) {
    writers.push_back(writer("/t" + std::to_string(i), bus::MessageType<LaserScan>::name));
  }
  test::StatusWatch watch(robot_);
  const auto status = watch.wait_for(*host_, [](const auto& now) {
    return now.message().find("topics are not shown") != std::string::npos;
  });
  EXPECT_THAT(status.message(), testing::HasSubstr("max_topics"));
  const auto read = [&] {
    return std::count_if(writers.begin(), writers.end(),
                         [](const auto& one) { return one->matched() > 0; });
  };
  EXPECT_TRUE(comes_true([&] { return read() > 0; }));
  EXPECT_LE(read(), 6);
  std::erase_if(writers, [](const auto& one) { return one->matched() > 0; });
  EXPECT_TRUE(comes_true([&] { return read() > 0; })) << "others take the place of those";
  host_->stop();
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
