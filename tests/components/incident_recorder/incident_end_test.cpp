// SPDX-License-Identifier: Apache-2.0
/// That incidents end, whatever is published and whenever the process stops.
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/components/incident_recorder/incident_recorder_fixture.hpp"

namespace strata::incident_recorder {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST_F(IncidentRecorderTest, IsKeptFromNothingByATopicThatItCannotRead) {
  const auto robot = test::make_participant();
  const auto sees = [&](const std::string& topic) {
    return test::comes_true([&] { return robot->published_topics().contains(topic); });
  };
  // Its process has both with another type; one is there before it, one comes later.
  const bus::Reader<LaserScan> own(robot, "/a_odd", bus::qos_profile("default"), [](auto) {});
  const bus::Reader<LaserScan> late_own(robot, "/b_odd", bus::qos_profile("default"), [](auto) {});
  const bus::RawWriter odd(participant_, "/a_odd", "std_msgs/msg/String",
                           bus::qos_profile("default"));
  ASSERT_TRUE(sees("/a_odd"));
  ASSERT_NO_THROW(start(", after_s: 0.0, rest_s: 0.0", robot));
  const bus::RawWriter late_odd(participant_, "/b_odd", "std_msgs/msg/String",
                                bus::qos_profile("default"));
  ASSERT_TRUE(sees("/b_odd"));
  for (const std::size_t count : {1U, 2U}) {  // one ends, so that another can begin
    tell("lost");
    EXPECT_THAT(wait_for(count), SizeIs(count));
    tell("good");
  }
  EXPECT_THAT(host_->take_errors(),
              testing::ElementsAre(HasSubstr("cannot read /a_odd: carries sensor_msgs"),
                                   HasSubstr("cannot read /b_odd: carries sensor_msgs")))
      << "each once";
  bus::Writer<LaserScan> good(test::make_participant(), "/a_odd", bus::qos_profile("default"));
  ASSERT_TRUE(test::comes_true([&] {
    host_->tick();
    return good.raw().wait_for_readers(2, std::chrono::milliseconds(0));
  })) << "with the type that can be read it is";
  good.publish(numbered(7));
  settle();
  ASSERT_TRUE(ask().success());
  const auto records = wait_for(3);
  ASSERT_THAT(records, SizeIs(3));
  EXPECT_EQ(scans_in(records[2].folder).at("/a_odd"), std::vector<int>{7});
}

TEST_F(IncidentRecorderTest, ThatWasPromisedIsKeptThoughTheProcessEndsFirst) {
  start(", after_s: 0.0, rest_s: 1000.0");
  tell("lost");
  settle();
  scans_.publish(numbered(7));
  ASSERT_TRUE(ask().success()) << "no tick has looked after the first one yet";
  host_->stop();
  const auto records = read_records(out());
  ASSERT_THAT(records, SizeIs(2));
  EXPECT_EQ(records[1].reasons[0].kind, "asked");
  EXPECT_TRUE(records[1].is_complete);
  EXPECT_EQ(scans_in(records[1].folder).at("/scan"), std::vector<int>{7});
  EXPECT_THAT(host_->take_errors(), IsEmpty());
}

}  // namespace
}  // namespace strata::incident_recorder
