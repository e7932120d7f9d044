// SPDX-License-Identifier: Apache-2.0
/// A bag into another storage, message by message.
#pragma once

#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "components/log/bag.hpp"
#include "core/base/progress.hpp"

namespace strata::log {

struct CopyOptions {
  /// Seconds from the recording of the first scan (without scans: of the first message); messages
  /// outside are left out. Latched transforms (tf_static) from before are kept, with the stamp of
  /// the cut.
  double from_s = 0.0;
  double to_s = std::numeric_limits<double>::infinity();
  Progress* progress = nullptr;
};

struct CopyReport {
  std::map<std::string, std::size_t> messages;  ///< copied, per topic
  std::string first_topic_of_scans;             ///< empty when the bag has none
  BagDamage damage;                             ///< what could not be read
  /// Topics of a ROS 1 bag whose types are not known here: ROS 2 could not read the messages, and
  /// would not open a bag that has them. "/imu (1200 sensor_msgs/Imu)".
  std::vector<std::string> left_out;
};

/// Copies every message with its bytes and its stamp, of types known here or not, and every topic
/// with its type and QoS, written aside and renamed; of a ROS 1 bag what is in left_out stays
/// behind. Without a cut nothing is decoded. Throws
/// InputError when the bag cannot be read, OutputError when the folder cannot be written.
[[nodiscard]] CopyReport copy_bag(const std::filesystem::path& in,
                                  const std::filesystem::path& folder, const BagOptions& format,
                                  const CopyOptions& options = {});

}  // namespace strata::log
