// SPDX-License-Identifier: Apache-2.0
/// What waits for a component that is not active.
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "components/runtime/component.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::runtime {
namespace {

using sensor_msgs::msg::LaserScan;

LaserScan scan_of(const std::string& frame) {
  LaserScan scan;
  scan.header().frame_id(frame);
  return scan;
}

/// Keeps the frames of latched scans, of which two of each writer wait while it is inactive.
class Resting final : public Component {
 public:
  using Component::Component;
  std::vector<std::string> frames;  ///< read while nothing comes

 private:
  void on_configure() override {
    bus::QosProfile qos = bus::qos_profile("latched");
    qos.depth = 1000;
    subscribe_raw(
        resolve("in"), bus::MessageType<LaserScan>::name, qos,
        [this](const bus::RawMessage& message) {
          frames.push_back(convert::from_cdr<LaserScan>(message.cdr, "/in").header().frame_id());
        },
        {.latched_depth = 2});
  }
};

TEST(RestingComponent, KeepsOfWhatIsLatchedTheLastOfEachWriterAndWhatCameWithItWhileItRests) {
  const auto participant = test::make_participant();
  bus::QosProfile qos = bus::qos_profile("latched");
  qos.depth = 100;
  bus::Writer<LaserScan> mounting(participant, "/in", qos);  // tells one thing in several messages
  bus::Writer<LaserScan> map(participant, "/in", qos);
  for (const char* frame : {"laser", "camera", "wheel"}) mounting.publish(scan_of(frame));
  Registry registry;
  registry.add<Resting>("strata::Resting");
  const auto host =
      test::make_host("{type: strata::Resting, name: resting}", registry, participant);
  auto& resting = dynamic_cast<Resting&>(*host->components().front());
  const auto wait = [] {
    std::this_thread::sleep_for(Reception::kBurst + std::chrono::milliseconds(200));
  };
  for (const char* frame : {"1", "2", "3"}) {
    wait();
    map.publish(scan_of(frame));
  }
  ASSERT_TRUE(test::comes_true([&] { return resting.counts().received == 6; }));
  EXPECT_EQ(resting.counts().ignored, 1U);
  resting.activate();
  EXPECT_THAT(resting.frames, testing::ElementsAre("laser", "camera", "wheel", "2", "3"));
  resting.deactivate();
  wait();
  for (const char* frame : {"4", "5", "6"}) map.publish(scan_of(frame));
  ASSERT_TRUE(test::comes_true([&] { return resting.counts().received == 9; }));
  EXPECT_EQ(resting.counts().ignored, 1U) << "they came together";
  wait();
  map.publish(scan_of("7"));
  ASSERT_TRUE(test::comes_true([&] { return resting.counts().received == 10; }));
  resting.activate();
  EXPECT_THAT(resting.frames, testing::ElementsAre("laser", "camera", "wheel", "2", "3", "6", "7"));
  EXPECT_EQ(resting.counts().done(), resting.counts().received);
}

}  // namespace
}  // namespace strata::runtime
