// SPDX-License-Identifier: Apache-2.0
/// The point clouds of a bag, which a replay sends beside its scans.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "strata_idl/sensor_msgs.h"
#include "strata_idl/tf2_msgs.h"

#include "components/log/bag.hpp"
#include "core/base/time.hpp"

namespace strata::tools {

class ReplayClouds {
 public:
  struct Outputs {
    std::function<void(const tf2_msgs::msg::TFMessage&)> tf_static;
    std::function<void(const sensor_msgs::msg::PointCloud2&)> points;
  };
  /// Null when `path` is no bag or holds no sensor_msgs/PointCloud2. Of several topics: the first
  /// by name.
  [[nodiscard]] static std::unique_ptr<ReplayClouds> open(const std::filesystem::path& path,
                                                          Outputs outputs);

  /// Sends the clouds up to a moment, as they were recorded; before the first, what the bag's
  /// /tf_static says, its robot frame called base_link, as in a replay's other messages. Clouds
  /// that make no sense are sent too when they can be read at all: components must bear them.
  void publish_until(Stamp stamp);

 private:
  ReplayClouds(const std::filesystem::path& path, std::string topic, Outputs outputs);
  /// The bag's transforms that hold at all times.
  [[nodiscard]] tf2_msgs::msg::TFMessage mountings() const;
  void read_next();

  std::filesystem::path path_;
  std::string topic_;
  Outputs outputs_;
  std::unique_ptr<log::BagReader> bag_;
  std::optional<sensor_msgs::msg::PointCloud2> next_;
  bool has_begun_ = false;
};

}  // namespace strata::tools
