// SPDX-License-Identifier: Apache-2.0
#include "tools/doctor/listen.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "components/bus/endpoint.hpp"
#include "tests/components/bus/domain.hpp"

namespace strata::doctor {
namespace {

constexpr const char* kMap = "nav_msgs/msg/OccupancyGrid";
constexpr auto kPatience = std::chrono::seconds(60);

/// Goes on for as long as the condition says, and sleeps.
template <typename Condition>
auto as_long_as(Condition condition) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  return [condition, deadline](double seconds) {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    return condition() && std::chrono::steady_clock::now() < deadline;
  };
}

std::vector<std::uint8_t> a_map() { return convert::to_cdr(nav_msgs::msg::OccupancyGrid()); }

TEST(Listening, AsksALatchedWriterForWhatItPublishedThoughAnotherWriterIsNotLatched) {
  const auto robot = test::make_participant();
  bus::RawWriter volatile_one(robot, "/map", kMap, bus::qos_profile("default"));
  bus::RawWriter latched(robot, "/map", kMap, bus::qos_profile("latched"));
  latched.publish(a_map());
  const auto doctor = test::make_participant();
  Observed observed;
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!observed.heard[latched.guid()].has_latched &&
         std::chrono::steady_clock::now() < deadline) {
    int rounds = 0;
    observed = listen(doctor, as_long_as([&] { return ++rounds < 5; }));
  }
  EXPECT_TRUE(observed.heard.at(latched.guid()).has_latched);
  EXPECT_FALSE(observed.heard.at(volatile_one.guid()).has_latched);
}

TEST(Listening, CountsTheTimeOfAWriterFromWhenItIsThere) {
  const auto robot = test::make_participant();
  const bus::RawWriter early(robot, "/map", kMap, bus::qos_profile("latched"));
  const auto doctor = test::make_participant();
  const auto knows = [&](const bus::RawWriter& writer) {
    const bus::DomainView view = doctor->view();
    return std::any_of(view.endpoints.begin(), view.endpoints.end(),
                       [&](const auto& endpoint) { return endpoint.guid == writer.guid(); });
  };
  std::unique_ptr<bus::RawWriter> late;
  const Observed observed = listen(doctor, as_long_as([&] {
                                     if (!knows(early)) return true;
                                     if (late) return !knows(*late);
                                     late = std::make_unique<bus::RawWriter>(
                                         robot, "/late_map", kMap, bus::qos_profile("latched"));
                                     return true;
                                   }));
  ASSERT_EQ(observed.heard.count(early.guid()), 1U);
  const auto heard = observed.heard.find(late->guid());
  const double known_s = heard == observed.heard.end() ? 0.0 : heard->second.known_s;
  EXPECT_LT(known_s, observed.heard.at(early.guid()).known_s);
  EXPECT_LT(observed.heard.at(early.guid()).known_s, observed.listened_s);
}

}  // namespace
}  // namespace strata::doctor
