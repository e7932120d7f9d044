// SPDX-License-Identifier: Apache-2.0
/// A robot that strata::VolumeMapper listens to, and what it answers.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include "components/convert/cloud_messages.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/volume_mapper/register.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/components/runtime/status_watch.hpp"

namespace strata::volume_mapper {
using octomap_msgs::msg::Octomap;
using sensor_msgs::msg::PointCloud2;
using tf2_msgs::msg::TFMessage;

inline TFMessage transform(const std::string& parent, const std::string& child, double time_s,
                           double x) {
  geometry_msgs::msg::TransformStamped stamped;
  stamped.header(convert::make_header(Stamp::from_seconds(time_s), parent));
  stamped.child_frame_id(child);
  stamped.transform().translation().x(x);
  stamped.transform().rotation().w(1.0);
  TFMessage message;
  message.transforms({stamped});
  return message;
}

inline std::vector<Eigen::Vector3f> wall(float x) {
  std::vector<Eigen::Vector3f> points;
  for (int y = -5; y <= 5; ++y) {
    for (int z = -5; z <= 5; ++z) {
      points.emplace_back(x, 0.1F * static_cast<float>(y) + 0.05F,
                          0.1F * static_cast<float>(z) + 0.05F);
    }
  }
  return points;
}

inline octomap::OcTree tree_of(const Octomap& message) {
  octomap::OcTree tree(message.resolution());
  std::istringstream data(std::string(message.data().begin(), message.data().end()));
  tree.readBinaryData(data);
  return tree;
}

inline bool is_occupied(const octomap::OcTree& tree, double x, double y, double z) {
  const octomap::OcTreeNode* node = tree.search(x, y, z);
  return node != nullptr && tree.isNodeOccupied(node);
}

/// A robot that publishes, and what the component answers.
class Robot {
 public:
  explicit Robot(const std::string& parameters)
      : participant_(test::make_participant()),
        maps_(participant_, "/octomap_binary", "latched"),
        colored_(participant_, "/octomap_color", "latched"),
        points_(participant_, "/points", bus::qos_profile("lossless")),
        tf_(participant_, "/tf", bus::qos_profile("tf")),
        tf_static_(participant_, "/tf_static", bus::qos_profile("tf_static")),
        scans_(participant_, "/labeled_scan", bus::qos_profile("lossless")),
        health_(participant_, "/localization_health", bus::qos_profile("tf")),
        watch_(participant_) {
    register_component(registry_);
    host_ = test::make_host(
        "{type: strata::VolumeMapper, name: mapper, parameters: {points_qos: lossless, " +
            parameters + "}}",
        registry_, test::make_participant());
    host_->activate();
    const std::chrono::seconds patience(20);
    EXPECT_TRUE(points_.raw().wait_for_readers(1, patience));
    EXPECT_TRUE(tf_.raw().wait_for_readers(1, patience));
    EXPECT_TRUE(scans_.raw().wait_for_readers(1, patience));
    if (parameters.find("health_topic") != std::string::npos) {
      EXPECT_TRUE(health_.raw().wait_for_readers(1, patience));
    }
    tf_static_.publish(transform("base_link", "lidar", 0.0, 0.25));
  }
  void move(double time_s, double x) { tf_.publish(transform("map", "base_link", time_s, x)); }
  void see(double time_s, const std::vector<Eigen::Vector3f>& points,
           const std::string& frame = "lidar") {
    publish(convert::to_message(points, Stamp::from_seconds(time_s), frame));
  }
  /// Points that were measured time_s + offset_s.
  void see_over_time(double time_s, const std::vector<Eigen::Vector3f>& points,
                     const std::vector<float>& offset_s) {
    convert::CloudColumns columns;
    columns.offset_s = offset_s;
    publish(convert::to_message(points, Stamp::from_seconds(time_s), "lidar", columns));
  }
  void see_colored(double time_s, const std::vector<Eigen::Vector3f>& points, std::uint32_t rgb) {
    convert::CloudColumns columns;
    columns.rgb.assign(points.size(), rgb);
    publish(convert::to_message(points, Stamp::from_seconds(time_s), "lidar", columns));
  }
  void publish(const PointCloud2& message) { points_.publish(message); }
  void label(const PosedScan& scan) { scans_.publish(convert::to_message(scan, "map", "laser")); }
  void tell_health(double time_s, bool is_localized, bool is_lost = false) {
    strata_msgs::msg::LocalizationHealth message;
    message.header(convert::make_header(Stamp::from_seconds(time_s), "map"));
    message.localized(is_localized);
    message.lost(is_lost);
    health_.publish(message);
  }
  /// The first status that says so.
  [[nodiscard]] test::DiagnosticStatus status(const std::string& key, const std::string& value) {
    return watch_.wait_for(*host_,
                           [&](const auto& now) { return test::value_of(now, key) == value; });
  }
  /// Two scans of which all beams hit something that moves, 2.8 m ahead.
  void label_moving(double first_s, double last_s) {
    PosedScan scan;
    scan.scan.angle_min_rad = -0.02F;
    scan.scan.angle_increment_rad = 0.01F;
    scan.scan.range_max_m = 10.0F;
    scan.scan.ranges_m.assign(5, 2.8F);
    scan.static_probability.assign(5, 0.1F);
    for (const double time_s : {first_s, last_s}) {
      scan.scan.stamp = Stamp::from_seconds(time_s);
      label(scan);
    }
  }
  [[nodiscard]] std::vector<Octomap> wait_for(std::size_t maps) { return maps_.wait_for(maps); }
  [[nodiscard]] std::vector<Octomap> wait_for_colored(
      std::size_t maps, std::chrono::milliseconds patience = std::chrono::seconds(20)) {
    return colored_.wait_for(maps, patience);
  }
  /// While the component may hold a map back, since it took long.
  [[nodiscard]] std::vector<Octomap> tick_for(std::size_t maps) { return tick_for(maps_, maps); }
  [[nodiscard]] std::vector<Octomap> tick_for_colored(std::size_t maps) {
    return tick_for(colored_, maps);
  }
  void deactivate() { host_.reset(); }
  [[nodiscard]] runtime::Host& host() { return *host_; }
  void tick() { host_->tick(); }

 private:
  [[nodiscard]] std::vector<Octomap> tick_for(test::Collector<Octomap>& collected,
                                              std::size_t maps) {
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (collected.wait_for(maps, std::chrono::milliseconds(20)).size() < maps &&
           std::chrono::steady_clock::now() < patience) {
      tick();
    }
    return collected.wait_for(maps, std::chrono::milliseconds(0));
  }

  std::shared_ptr<bus::Participant> participant_;
  test::Collector<Octomap> maps_;
  test::Collector<Octomap> colored_;
  bus::Writer<PointCloud2> points_;
  bus::Writer<TFMessage> tf_;
  bus::Writer<TFMessage> tf_static_;
  bus::Writer<strata_msgs::msg::LabeledScan> scans_;
  bus::Writer<strata_msgs::msg::LocalizationHealth> health_;
  test::StatusWatch watch_;
  runtime::Registry registry_;
  std::unique_ptr<runtime::Host> host_;
};

}  // namespace strata::volume_mapper
