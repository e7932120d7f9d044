// SPDX-License-Identifier: Apache-2.0
/// Two mappers in two namespaces of one process keep their own maps.
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/convert/cloud_messages.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/volume_mapper/register.hpp"
#include "core/volume/volume_map.hpp"
#include "tests/components/runtime/host_fixture.hpp"

namespace strata::volume_mapper {
namespace {

constexpr double kTime_s = 1.5;

/// A robot with a namespace of its own; tf is everybody's.
class NamedRobot {
 public:
  explicit NamedRobot(const std::string& scope)
      : participant_(test::make_participant()),
        maps_(participant_, scope + "/octomap_binary", "latched"),
        points_(participant_, scope + "/points", bus::qos_profile("lossless")) {
    register_component(registry_);
    host_ = test::make_host("{type: strata::VolumeMapper, name: mapper, namespace: " + scope +
                                ", parameters: {points_qos: lossless, publish_period_s: 0}}",
                            registry_, test::make_participant());
    host_->activate();
    EXPECT_TRUE(points_.raw().wait_for_readers(1, std::chrono::seconds(20)));
  }
  void see(const std::vector<Eigen::Vector3f>& points) {
    points_.publish(convert::to_message(points, Stamp::from_seconds(kTime_s), "lidar"));
  }
  [[nodiscard]] std::vector<octomap_msgs::msg::Octomap> wait_for_map() { return maps_.wait_for(1); }

 private:
  std::shared_ptr<bus::Participant> participant_;
  test::Collector<octomap_msgs::msg::Octomap> maps_;
  bus::Writer<sensor_msgs::msg::PointCloud2> points_;
  runtime::Registry registry_;
  std::unique_ptr<runtime::Host> host_;
};

std::vector<std::int8_t> map_of(const std::vector<Eigen::Vector3f>& points) {
  volume::VolumeMap map(volume::VolumeConfig{});
  volume::Cloud cloud;
  cloud.points_m = points;
  WorkerPool pool(1);
  map.insert(cloud, {}, pool);
  const std::string data = map.binary_message_data();
  return {data.begin(), data.end()};
}

TEST(VolumeMapper, OfTwoInstancesEachMapsItsOwnClouds) {
  NamedRobot a("/a");
  NamedRobot b("/b");
  const std::vector<Eigen::Vector3f> near{{1.0F, 0.0F, 0.0F}, {1.0F, 0.2F, 0.0F}};
  const std::vector<Eigen::Vector3f> far{{3.0F, 0.0F, 0.5F}};
  a.see(near);
  b.see(far);
  // The clouds wait until tf says where they were seen from.
  const auto participant = test::make_participant();
  bus::Writer<tf2_msgs::msg::TFMessage> tf(participant, "/tf", bus::qos_profile("tf"));
  ASSERT_TRUE(tf.raw().wait_for_readers(2, std::chrono::seconds(20)));
  for (const double time_s : {kTime_s - 0.25, kTime_s + 0.25}) {
    geometry_msgs::msg::TransformStamped stamped;
    stamped.header(convert::make_header(Stamp::from_seconds(time_s), "map"));
    stamped.child_frame_id("lidar");
    stamped.transform(convert::to_transform(Pose2{}));
    tf2_msgs::msg::TFMessage message;
    message.transforms({stamped});
    tf.publish(message);
  }
  const auto map_a = a.wait_for_map();
  const auto map_b = b.wait_for_map();
  ASSERT_EQ(map_a.size(), 1U);
  ASSERT_EQ(map_b.size(), 1U);
  EXPECT_EQ(map_a[0].data(), map_of(near));
  EXPECT_EQ(map_b[0].data(), map_of(far));
  EXPECT_NE(map_a[0].data(), map_b[0].data());
}

}  // namespace
}  // namespace strata::volume_mapper
