// SPDX-License-Identifier: Apache-2.0
/// 3-D logs as clouds with poses.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "components/clouds/bag_poses.hpp"
#include "core/base/interface.hpp"
#include "core/volume/cloud.hpp"

namespace strata::clouds {

/// What reading could not make use of, and what it skipped.
struct CloudReport {
  std::string format;  ///< for people: "OctoMap log"
  std::size_t clouds = 0;
  std::size_t bad_lines = 0;            ///< unreadable lines, records or messages
  std::size_t unreadable_clouds = 0;    ///< messages without fields, with too little data, ...
  std::string first_bad;                ///< where the first one is and why
  std::size_t clouds_without_pose = 0;  ///< skipped with their points
  std::size_t points_without_pose = 0;
};

/// Clouds one after the other, so that a log need not fit into memory.
class CloudReader : public Interface {
 public:
  /// Told by content: OctoMap's text log (`NODE x y z roll pitch yaw`, then a point a line; plain
  /// or gzipped) and its binary scan graph. Neither has stamps; clouds are put a second apart. And
  /// rosbag2 bags
  /// (`open_bag_clouds`).
  /// Poses are rounded as OctoMap rounds them, so that its tools and ours make the same tree.
  /// Throws InputError for anything else. options: for bags.
  [[nodiscard]] static std::unique_ptr<CloudReader> open(const std::filesystem::path& path,
                                                         const CloudReadOptions& options = {});

  /// The next cloud; false at the end. Damaged lines are skipped and counted; a damaged record
  /// ends the log.
  virtual bool next(volume::Cloud& cloud) = 0;
  [[nodiscard]] const CloudReport& report() const { return report_; }

 protected:
  void bad(const std::string& place_and_reason) {
    if (report_.bad_lines++ == 0) report_.first_bad = place_and_reason;
  }
  CloudReport report_;
};

}  // namespace strata::clouds
