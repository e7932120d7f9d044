// SPDX-License-Identifier: Apache-2.0
#include "tools/doctor/listen.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "components/bus/endpoint.hpp"
#include "components/security/keystore.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/test_data.hpp"

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

TEST(Listening, GoesOnAfterATopicThatItMayNotRead) {
  const test::TemporaryDirectory folder;
  const std::string place = (folder.path() / "keystore").string();
  const auto keystore = security::Keystore::create(place);
  for (const char* name : {"/robot", "/doctor"}) keystore.add(name);
  keystore.set_permissions("/doctor", {{}, {"rt/map"}});
  const auto join = [&](const std::string& enclave) {
    bus::ParticipantOptions options;
    options.domain = test::own_domain();
    options.transport = bus::Transport::kLoopback;
    options.enclave = enclave;
    options.security = {true, true, place};
    return std::make_shared<bus::Participant>(options);
  };
  const auto robot = join("/robot");
  const bus::RawWriter first(robot, "/forbidden", kMap, bus::qos_profile("latched"));
  bus::RawWriter map(robot, "/map", kMap, bus::qos_profile("latched"));
  const bus::RawWriter last(robot, "/secret", kMap, bus::qos_profile("latched"));
  map.publish(a_map());
  const auto doctor = join("/doctor");
  Observed observed;
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while ((!observed.heard[map.guid()].has_latched || observed.refused.size() < 2) &&
         std::chrono::steady_clock::now() < deadline) {
    int rounds = 0;
    ASSERT_NO_THROW(observed = listen(doctor, as_long_as([&] { return ++rounds < 5; })));
  }
  EXPECT_TRUE(observed.heard.at(map.guid()).has_latched);
  ASSERT_EQ(observed.refused.size(), 2U);
  EXPECT_EQ(observed.refused.count("/forbidden"), 1U);
  EXPECT_EQ(observed.refused.count("/secret"), 1U);
  std::size_t told = 0;
  for (const Finding& finding : examine(observed).findings) {
    if (finding.what.find("may not read") != std::string::npos) ++told;
  }
  EXPECT_EQ(told, 2U) << "one line each";
}

}  // namespace
}  // namespace strata::doctor
