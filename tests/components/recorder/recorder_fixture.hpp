// SPDX-License-Identifier: Apache-2.0
/// Recorders into every storage, and what their bags hold.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/bus/bag_service_types.hpp"
#include "components/bus/service.hpp"
#include "components/recorder/recorder.hpp"
#include "components/recorder/register.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::recorder {

using Messages = std::map<std::string, std::vector<std::vector<std::uint8_t>>>;

inline Messages read_bag(const std::filesystem::path& folder) {
  const auto reader = log::BagReader::open(folder);
  Messages messages;
  log::BagMessage message;
  while (reader->next(message)) {
    messages[reader->topics()[message.topic].name].push_back(message.data);
  }
  EXPECT_EQ(reader->damage().count, 0U);
  messages.erase("/rosout");  // the recorder's own log is there too
  return messages;
}

struct Storage {
  const char* name;
  const char* parameters;
  const char* description;  ///< what the reader tells of the bag
};

class RecorderStorage : public testing::TestWithParam<Storage> {
 protected:
  [[nodiscard]] std::unique_ptr<runtime::Host> make(const std::string& parameters) {
    return make_into(bag().string(), parameters);
  }
  [[nodiscard]] std::unique_ptr<runtime::Host> make_into(const std::string& out,
                                                         const std::string& parameters) {
    runtime::Registry registry;
    register_component(registry);
    return test::make_host("{type: strata::Recorder, name: recorder, parameters: {out: '" + out +
                               "', storage: " + GetParam().parameters + parameters + "}}",
                           registry, participant_);
  }
  [[nodiscard]] std::filesystem::path bag() const { return folder_.path() / "bag"; }
  [[nodiscard]] bus::Writer<sensor_msgs::msg::LaserScan> writer(const std::string& topic,
                                                                const std::string& qos) const {
    return {participant_, topic, bus::qos_profile(qos)};
  }
  template <typename S>
  typename bus::ServiceType<S>::Response call(
      const std::string& name, const typename bus::ServiceType<S>::Request& request = {}) {
    const auto response =
        bus::call_service<S>(participant_, "/recorder/" + name, request, std::chrono::seconds(20));
    EXPECT_TRUE(response.has_value()) << name;
    return response.value_or(typename bus::ServiceType<S>::Response());
  }
  std::shared_ptr<bus::Participant> participant_ = test::make_participant();

 private:
  test::TemporaryDirectory folder_;
};

/// As messages are stamped.
inline std::int64_t now_ns() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

inline sensor_msgs::msg::LaserScan numbered(int number) {
  sensor_msgs::msg::LaserScan scan;
  scan.header().stamp().sec(number);
  scan.ranges().assign(100, static_cast<float>(number));
  return scan;
}

}  // namespace strata::recorder
