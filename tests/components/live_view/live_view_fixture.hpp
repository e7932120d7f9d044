// SPDX-License-Identifier: Apache-2.0
/// A robot that publishes a map and scans over DDS, and a live view that ticks beside it.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/geometry_messages.hpp"
#include "components/live_view/live_view.hpp"
#include "components/live_view/register.hpp"
#include "components/runtime/diagnostics.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::live_view {

class LiveViewTest : public testing::Test {
 protected:
  std::shared_ptr<bus::Participant> robot_ = test::make_participant();
  bus::Writer<nav_msgs::msg::OccupancyGrid> maps_{robot_, std::string("/map"),
                                                  bus::qos_profile("latched")};
  bus::Writer<sensor_msgs::msg::LaserScan> scans_{robot_, std::string("/scan"),
                                                  bus::qos_profile("sensor_data")};
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
  static sensor_msgs::msg::LaserScan scan(int number) {
    sensor_msgs::msg::LaserScan made;
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

}  // namespace strata::live_view
