// SPDX-License-Identifier: Apache-2.0
/// A log in any format that we read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "components/log/bag.hpp"
#include "components/log/log_reader.hpp"
#include "core/geometry/pose3.hpp"

namespace strata::log {

/// What a bag holds beside scans and odometry.
struct LogExtras {
  struct Mounting {
    std::string frame;
    Pose3 robot_from_frame;
  };
  std::vector<Mounting> mountings;  ///< more of /tf_static
  std::vector<BagTopic> topics;
  std::vector<BagMessage> messages;  ///< of these topics, by stamp
};

/// A bag folder with /scan, /odom, /tf and /tf_static, written aside and renamed. Odometry at each
/// scan's stamp is written too, so that reading finds the very pose. Throws OutputError when the
/// folder exists and is not empty.
void write_bag(const std::filesystem::path& folder, const LogContent& content,
               const BagOptions& format, const LogExtras& extras = {});
inline void write_bag(const std::filesystem::path& folder, const LogContent& content,
                      BagStorage storage, BagCompression compression = BagCompression::kNone) {
  write_bag(folder, content, BagOptions{.storage = storage, .chunks = compression});
}

/// The QoS profile that rosbag2 (up to Humble) stores for a topic of a robot's driver.
[[nodiscard]] std::string recorded_qos(bool transient_local = false, bool reliable = true);

}  // namespace strata::log
