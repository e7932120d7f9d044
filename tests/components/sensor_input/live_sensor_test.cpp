// SPDX-License-Identifier: Apache-2.0
/// What a component on the domain makes of its scanners.
#include <functional>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/cloud_messages.hpp"
#include "components/runtime/sensor_component.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/components/runtime/status_watch.hpp"
#include "tests/components/sensor_input/recorded_robot.hpp"

namespace strata::runtime {
namespace {

using std::chrono::seconds;
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
    subscribe_sensors(read_parameters<SensorInputConfig>(), "lossless");
  }
  void on_diagnose(Health& health) const override { diagnose_input(health); }
  void on_observation(const Observation& observation) override {
    rosgraph_msgs::msg::Clock message;
    message.clock(convert::to_message(observation.scan.stamp));
    publish_(message);
  }
  std::function<void(const rosgraph_msgs::msg::Clock&)> publish_;
};

TEST(LiveSensor, TellsAMountingThatIsMissingOnceAndHearsEveryScanner) {
  Registry registry;
  registry.add<Listener>("test::Listener");
  const auto participant = test::make_participant();
  test::Collector<rosgraph_msgs::msg::Clock> heard(participant, "/heard", "lossless");
  test::StatusWatch watch(participant);
  const auto host = test::make_host(
      "{type: test::Listener, name: ear, parameters: {scan_topics: [front/scan], cloud_topics: "
      "[points], use_odometry: false, most_waiting_scans: 2}}",
      registry, test::make_participant());
  host->activate();
  const bus::QosProfile qos = bus::qos_profile("lossless");
  bus::Writer<sensor_msgs::msg::LaserScan> scans(participant, "/front/scan", qos);
  bus::Writer<sensor_msgs::msg::PointCloud2> clouds(participant, "/points", qos);
  ASSERT_TRUE(scans.raw().wait_for_readers(1, seconds(20)));
  ASSERT_TRUE(clouds.raw().wait_for_readers(1, seconds(20)));
  for (int i = 0; i < 6; ++i) scans.publish(test::sweep(1.0 + 0.1 * i, "front"));
  EXPECT_EQ(heard.wait_for(6).size(), 6U);
  const auto status = watch.wait_for(*host, [](const auto& now) {
    return now.message().find("tf_static does not tie front") != std::string::npos;
  });
  EXPECT_THAT(status.message(), HasSubstr("tf_static does not tie front to base_link"));
  EXPECT_THAT(host->take_errors(),
              ElementsAre(HasSubstr("/ear: tf_static does not tie front to base_link; the laser "
                                    "is taken to sit at its origin")));
  const std::vector<Eigen::Vector3f> points{{1.0F, 0.0F, 0.3F}};
  for (int i = 0; i < 5; ++i)
    clouds.publish(convert::to_message(points, test::at(2.0 + i), "roof"));
  EXPECT_EQ(heard.wait_for(11).size(), 11U);
  EXPECT_THAT(host->take_errors(), ElementsAre(HasSubstr("tf_static does not tie roof")));
}

}  // namespace
}  // namespace strata::runtime
