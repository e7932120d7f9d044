// SPDX-License-Identifier: Apache-2.0
/// What a component on the domain makes of its scanners.
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/cloud_messages.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/runtime/sensor_component.hpp"
#include "tests/across/sensor_input/recorded_robot.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/components/runtime/status_watch.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::runtime {
namespace {

using std::chrono::seconds;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

/// Tells the stamp of each observation.
class Listener final : public SensorComponent {
 public:
  using SensorComponent::SensorComponent;

 private:
  void on_declare() override { declare_parameters<SensorInputConfig>(); }
  void on_configure() override {
    publish_ = advertise<rosgraph_msgs::msg::Clock>("heard", "lossless");
    subscribe_sensors(read_parameters<SensorInputConfig>(), "lossless", "odom");
  }
  void on_diagnose(Health& health) const override { diagnose_input(health); }
  void on_observation(const Observation& observation) override {
    rosgraph_msgs::msg::Clock message;
    message.clock(convert::to_message(observation.scan.stamp));
    publish_(message);
  }
  std::function<void(const rosgraph_msgs::msg::Clock&)> publish_;
};

/// Is at work on its first observation until `is_free`.
class Busy final : public SensorComponent {
 public:
  using SensorComponent::SensorComponent;
  static inline std::atomic<bool> is_at_work = false;
  static inline std::atomic<bool> is_free = false;

 private:
  void on_declare() override { declare_parameters<SensorInputConfig>(); }
  void on_configure() override {
    subscribe_sensors(read_parameters<SensorInputConfig>(), "default");
  }
  void on_observation(const Observation& /*observation*/) override {
    is_at_work = true;
    is_free.wait(false);
  }
};

TEST(LiveSensor, KeepsTheOdometryOfSecondsWhileTheComponentIsBusy) {
  Registry registry;
  registry.add<Busy>("test::Busy");
  const auto participant = test::make_participant();
  const bus::QosProfile qos = bus::qos_profile("lossless");
  bus::Writer<tf2_msgs::msg::TFMessage> mountings(participant, "/tf_static",
                                                  bus::qos_profile("tf_static"));
  bus::Writer<sensor_msgs::msg::LaserScan> scans(participant, "/scan", qos);
  bus::Writer<nav_msgs::msg::Odometry> odometry(participant, "/odom", qos);
  tf2_msgs::msg::TFMessage mounting;
  mounting.transforms().push_back(convert::to_transform_stamped({}, Pose2{}, "base_link", "front"));
  mountings.publish(mounting);
  const auto host =
      test::make_host("{type: test::Busy, name: busy, parameters: {use_odometry: false}}", registry,
                      test::make_participant());
  host->activate();
  ASSERT_TRUE(scans.raw().wait_for_readers(1, seconds(20)));
  ASSERT_TRUE(odometry.raw().wait_for_readers(1, seconds(20)));
  const Component& busy = *host->components().front();
  // Reliable: it waits for a reader that does not know its writer yet. More of them would fill the
  // queue at once.
  scans.publish(test::sweep(1.0, "front"));
  ASSERT_TRUE(test::comes_true([] { return Busy::is_at_work.load(); }));
  const std::uint64_t before = busy.counts().received;
  constexpr std::uint64_t kMessages = 500;  // of a base at 100 Hz
  for (std::uint64_t i = 0; i < kMessages; ++i) {
    const Stamp stamp = Stamp::from_seconds(1.0 + 0.01 * static_cast<double>(i));
    odometry.publish(convert::to_odometry(stamp, Pose2{}, "odom", "base_link"));
  }
  EXPECT_TRUE(test::comes_true([&] { return busy.counts().received >= before + kMessages; }));
  Busy::is_free = true;
  Busy::is_free.notify_all();
  EXPECT_TRUE(test::comes_true([&] { return busy.counts().done() == busy.counts().received; }));
  EXPECT_EQ(busy.counts().dropped, 0U);
}

TEST(LiveSensor, TellsAMountingThatIsMissingOnceAndHearsEveryScanner) {
  Registry registry;
  registry.add<Listener>("test::Listener");
  const auto participant = test::make_participant();
  test::Collector<rosgraph_msgs::msg::Clock> heard(participant, "/heard", "lossless");
  test::StatusWatch watch(participant);
  const auto host = test::make_host(
      "{type: test::Listener, name: ear, parameters: {scan_topics: [front/scan], cloud_topics: "
      "[points], use_odometry: false, max_waiting_scans: 2, first_wait_s: 0}}",
      registry, test::make_participant());
  host->activate();
  const bus::QosProfile qos = bus::qos_profile("lossless");
  bus::Writer<sensor_msgs::msg::LaserScan> scans(participant, "/front/scan", qos);
  bus::Writer<sensor_msgs::msg::PointCloud2> clouds(participant, "/points", qos);
  ASSERT_TRUE(scans.raw().wait_for_readers(1, seconds(20)));
  ASSERT_TRUE(clouds.raw().wait_for_readers(1, seconds(20)));
  // The writer knows of a match before the reader does: what comes before that is lost.
  double now_s = 1.0;
  const auto is_newest_heard = [&] {
    const auto messages = heard.wait_for(0);
    return !messages.empty() && convert::from_message(messages.back().clock()) == test::at(now_s);
  };
  ASSERT_TRUE(test::comes_true([&] {
    scans.publish(test::sweep(now_s += 0.01, "front"));
    return !heard.wait_for(0).empty();
  }));
  for (int i = 0; i < 6; ++i) scans.publish(test::sweep(now_s += 0.01, "front"));
  EXPECT_TRUE(test::comes_true(is_newest_heard));
  const auto status = watch.wait_for(*host, [](const auto& now) {
    return now.message().find("tf_static does not connect front") != std::string::npos;
  });
  EXPECT_THAT(status.message(), HasSubstr("tf_static does not connect front to base_link"));
  EXPECT_THAT(
      host->take_errors(),
      ElementsAre(HasSubstr("/ear: tf_static does not connect front to base_link; the laser "
                            "is taken to sit at its origin")));
  const std::vector<Eigen::Vector3f> points{{1.0F, 0.0F, 0.3F}};
  const std::size_t swept = heard.wait_for(0).size();
  ASSERT_TRUE(test::comes_true([&] {
    clouds.publish(convert::to_message(points, test::at(now_s += 0.1), "roof"));
    return heard.wait_for(0).size() > swept;
  }));
  for (int i = 0; i < 5; ++i) {
    clouds.publish(convert::to_message(points, test::at(now_s += 0.1), "roof"));
  }
  EXPECT_TRUE(test::comes_true(is_newest_heard));
  EXPECT_THAT(host->take_errors(), ElementsAre(HasSubstr("tf_static does not connect roof")));
}

TEST(LiveSensor, TellsOnceThatOdometryIsOfAnotherFrameThanTheMapsTransform) {
  Registry registry;
  registry.add<Listener>("test::Listener");
  const auto participant = test::make_participant();
  const auto host =
      test::make_host("{type: test::Listener, name: ear}", registry, test::make_participant());
  host->activate();
  bus::Writer<nav_msgs::msg::Odometry> writer(participant, "/odom", bus::qos_profile("lossless"));
  ASSERT_TRUE(writer.raw().wait_for_readers(1, seconds(20)));
  std::vector<std::string> errors;
  double now_s = 0.0;
  const auto are_told = [&](const std::string& frame) {
    nav_msgs::msg::Odometry message = test::odometry(now_s += 0.1, {});
    message.header().frame_id(frame);
    writer.publish(message);
    for (std::string& error : host->take_errors()) errors.push_back(std::move(error));
    return !errors.empty();
  };
  EXPECT_TRUE(test::comes_true([&] { return are_told("robot1/odom"); }));
  for (int i = 0; i < 3; ++i) (void)are_told("robot1/odom");
  EXPECT_THAT(errors, ElementsAre(AllOf(HasSubstr("/odom: is in the frame robot1/odom, and the "
                                                  "map's transform is to odom"),
                                        HasSubstr("set odometry_frame"))));
}

}  // namespace
}  // namespace strata::runtime
