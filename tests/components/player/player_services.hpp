// SPDX-License-Identifier: Apache-2.0
/// A player that plays a short drive, and the services it is led by.
#pragma once

#include <chrono>
#include <filesystem>
#include <future>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "components/bus/bag_service_types.hpp"
#include "components/bus/service.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/runtime/parameters.hpp"
#include "tests/components/player/drive.hpp"
#include "tests/support/test_data.hpp"

namespace strata::player {

using sensor_msgs::msg::LaserScan;

inline constexpr int kScans = 20;

class PlayerServices : public testing::TestWithParam<const char*> {
 protected:
  void start(const std::string& parameters) {
    test::write_drive(bag(), kScans);
    host_ = test::play(bag(),
                       std::string(GetParam() == std::string("robot") ? "" : ", topics: [/scan]") +
                           ", mode: " + GetParam() + parameters,
                       participant_);
    host_->activate();
  }
  [[nodiscard]] std::filesystem::path bag() const { return folder_.path() / "bag"; }
  std::vector<std::string> take_errors() { return host_->take_errors(); }
  void TearDown() override {
    if (host_) {
      EXPECT_TRUE(host_->take_errors().empty());
    }
  }
  /// The answer to a call; an empty one when there is none, which fails the test.
  template <typename S>
  typename bus::ServiceType<S>::Response call(
      const std::string& name, const typename bus::ServiceType<S>::Request& request = {},
      std::chrono::seconds patience = std::chrono::seconds(20)) {
    const auto response = bus::call_service<S>(participant_, "/player/" + name, request, patience);
    EXPECT_TRUE(response.has_value()) << name;
    return response.value_or(typename bus::ServiceType<S>::Response());
  }
  void pause() { call<bus::srv::Pause>("pause"); }
  void resume() { call<bus::srv::Resume>("resume"); }
  bool is_paused() { return call<bus::srv::IsPaused>("is_paused").paused(); }
  bool play_next() { return call<bus::srv::PlayNext>("play_next").success(); }
  double rate() { return call<bus::srv::GetRate>("get_rate").rate(); }
  bool set_rate(double rate) {
    rosbag2_interfaces::srv::SetRate_Request request;
    request.rate(rate);
    return call<bus::srv::SetRate>("set_rate", request).success();
  }
  bool seek(double seconds, std::chrono::seconds patience = std::chrono::seconds(20)) {
    rosbag2_interfaces::srv::Seek_Request request;
    request.time(convert::to_message(Stamp::from_seconds(seconds)));
    return call<bus::srv::Seek>("seek", request, patience).success();
  }
  /// Of a seek that is held open, and with it all that is done meanwhile.
  std::future<bool> begin_to_seek(double seconds) {
    return std::async(std::launch::async,
                      [this, seconds] { return seek(seconds, std::chrono::seconds(60)); });
  }
  bool set_parameter(const std::string& name, rcl_interfaces::msg::ParameterValue value) {
    rcl_interfaces::srv::SetParameters_Request request;
    request.parameters({runtime::parameter(name, std::move(value))});
    const auto response = call<bus::srv::SetParameters>("set_parameters", request);
    // Neither refused nor put off until the next configure.
    return response.results().at(0).successful() && response.results()[0].reason().empty();
  }
  rcl_interfaces::msg::ParameterValue parameter(const std::string& name) {
    rcl_interfaces::srv::GetParameters_Request request;
    request.names({name});
    return call<bus::srv::GetParameters>("get_parameters", request).values().at(0);
  }
  /// The numbers of the scans that came, at least `count`.
  std::vector<int> played(std::size_t count) {
    std::vector<int> numbers;
    for (const LaserScan& scan : scans_.wait_for(count)) {
      numbers.push_back(static_cast<int>(scan.ranges()[2]) - 3);
    }
    return numbers;
  }

 private:
  test::TemporaryDirectory folder_;
  std::shared_ptr<bus::Participant> participant_ = test::make_participant();
  test::Collector<LaserScan> scans_{participant_, "/scan", "lossless"};
  std::unique_ptr<runtime::Host> host_;
};

inline std::vector<int> first(int count) {
  std::vector<int> numbers;
  for (int i = 0; i < count; ++i) numbers.push_back(i);
  return numbers;
}

}  // namespace strata::player
