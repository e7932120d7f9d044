// SPDX-License-Identifier: Apache-2.0
/// Writes ROS 1 bags by the published format (http://wiki.ros.org/Bags/Format/2.0) and messages by
/// their ROS 1 definitions, field by field: nothing here is shared with what reads them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "strata_idl/geometry_msgs.h"
#include "strata_idl/nav_msgs.h"
#include "strata_idl/sensor_msgs.h"
#include "strata_idl/tf2_msgs.h"

#include "core/base/time.hpp"

namespace strata::log::test_log {

/// Bytes one after the other, numbers little-endian without gaps.
class Ros1Bytes {
 public:
  Ros1Bytes& u8(std::uint8_t value) { return number(value, 1); }
  Ros1Bytes& u32(std::uint32_t value) { return number(value, 4); }
  Ros1Bytes& u64(std::uint64_t value) { return number(value, 8); }
  Ros1Bytes& f32(float value);
  Ros1Bytes& f64(double value);
  Ros1Bytes& raw(std::string_view bytes);
  Ros1Bytes& text(std::string_view value) { return u32(length(value)).raw(value); }
  /// A record's field NAME=VALUE.
  Ros1Bytes& field(std::string_view name, std::string_view value);
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

  static std::uint32_t length(std::string_view value) {
    return static_cast<std::uint32_t>(value.size());
  }

 private:
  Ros1Bytes& number(std::uint64_t value, int size);
  std::string bytes_;
};

/// Messages as ROS 1 serializes them; the header's seq is `seq`.
[[nodiscard]] std::string ros1_message(const sensor_msgs::msg::LaserScan& scan, std::uint32_t seq);
[[nodiscard]] std::string ros1_message(const sensor_msgs::msg::PointCloud2& cloud,
                                       std::uint32_t seq);
[[nodiscard]] std::string ros1_message(const nav_msgs::msg::Odometry& odometry, std::uint32_t seq);
[[nodiscard]] std::string ros1_message(const tf2_msgs::msg::TFMessage& transforms,
                                       std::uint32_t seq);
[[nodiscard]] std::string ros1_message(const geometry_msgs::msg::PoseStamped& pose,
                                       std::uint32_t seq);

struct Ros1Topic {
  std::string name;
  std::string type;
  std::string md5;
  bool latched = false;
};
extern const Ros1Topic kRos1Scan, kRos1Odometry, kRos1Transforms, kRos1FixedTransforms,
    kRos1OldTransforms, kRos1Truth, kRos1Cloud, kRos1Chat;

/// How recording ended.
enum class Ros1End {
  kWhole,
  kNoIndex,         ///< chunks are finished, and nothing tells of them
  kUnfinishedChunk  ///< the last chunk's lengths are still zero
};
struct Ros1Format {
  std::string compression = "none";  ///< or bz2, lz4
  std::size_t chunk_bytes = 20'000;
  Ros1End end = Ros1End::kWhole;
  /// Before a chunk's index stands how long it is. ROS 1 of 2010 stated 20 bytes for each entry of
  /// 12; whoever reads goes by how many entries it counts.
  std::uint32_t stated_entry_bytes = 12;
};

class Ros1BagMaker {
 public:
  explicit Ros1BagMaker(Ros1Format format = {}) : format_(std::move(format)) {}
  void write(const Ros1Topic& topic, Stamp stamp, const std::string& message);
  /// The bag. Nothing may be written afterwards.
  [[nodiscard]] std::string finish();

 private:
  struct Chunk {
    std::uint64_t position = 0;
    std::uint64_t begin = ~std::uint64_t{0};
    std::uint64_t end = 0;
    std::map<std::uint32_t, std::vector<std::pair<std::uint64_t, std::uint32_t>>> entries;
  };
  void finish_chunk(bool with_lengths);
  [[nodiscard]] std::string connection(std::uint32_t id) const;
  [[nodiscard]] std::string bag_header(std::uint64_t index_at) const;

  Ros1Format format_;
  std::string file_;  ///< behind the bag's header
  std::string records_;
  Chunk chunk_;
  std::vector<Chunk> chunks_;
  std::vector<Ros1Topic> topics_;
};

/// The messages of a rosbag2 bag as ROS 1 would have recorded them; other types than those above
/// are left out.
[[nodiscard]] std::string ros1_bag_of(const std::filesystem::path& rosbag2,
                                      const Ros1Format& format = {});

/// Where the first chunk of a bag lies.
constexpr std::size_t kRos1FirstChunk = 4117;

}  // namespace strata::log::test_log
