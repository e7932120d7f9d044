// SPDX-License-Identifier: Apache-2.0
#include "components/log/ros1_messages.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>

#include "components/convert/cdr.hpp"
#include "components/log/byte_cursor.hpp"

namespace strata::log {
namespace {

using convert::MessageLayout;

/// Types that are field by field the same in ROS 1 and 2, but for the Header's seq. The sums are
/// those of ROS 1's definitions (the MD5 of the text without comments, in which the sum of a part
/// stands for its type).
struct Known {
  std::string_view ros1;
  std::string_view md5;
  std::string_view ros2;
};
constexpr Known kKnown[] = {
    {"geometry_msgs/PointStamped", "c63aecb41bfdfd6b7e1fac37c7cbe7bf",
     "geometry_msgs/msg/PointStamped"},
    {"geometry_msgs/PoseStamped", "d3812c3cbc69362b77dc0b19b345f8f5",
     "geometry_msgs/msg/PoseStamped"},
    {"geometry_msgs/PoseWithCovarianceStamped", "953b798c0f514ff060a53a3498ce6246",
     "geometry_msgs/msg/PoseWithCovarianceStamped"},
    {"geometry_msgs/Twist", "9f195f881246fdfa2798d1d3eebca84a", "geometry_msgs/msg/Twist"},
    {"nav_msgs/OccupancyGrid", "3381f2d731d4076ec5c71b0759edbe4e", "nav_msgs/msg/OccupancyGrid"},
    {"nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7", "nav_msgs/msg/Odometry"},
    {"nav_msgs/Path", "6227e2b7e9cce15051f669a5e197bbf7", "nav_msgs/msg/Path"},
    {"sensor_msgs/CameraInfo", "c9a58c1b0b154e0e6da7578cb991d214", "sensor_msgs/msg/CameraInfo"},
    {"sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743", "sensor_msgs/msg/Image"},
    {"sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369", "sensor_msgs/msg/LaserScan"},
    {"sensor_msgs/PointCloud2", "1158d486dd51d683ce2f1be655c3c181", "sensor_msgs/msg/PointCloud2"},
    {"std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1", "std_msgs/msg/String"},
    {"tf/tfMessage", "94810edda583a504dfda3829e70d7eec", "tf2_msgs/msg/TFMessage"},
    {"tf2_msgs/TFMessage", "94810edda583a504dfda3829e70d7eec", "tf2_msgs/msg/TFMessage"},
};

/// Reads what is packed without gaps, little-endian, and writes it aligned.
class Transcoder {
 public:
  explicit Transcoder(View message) : in_(message) {
    out_.reserve(message.size() + message.size() / 8 + 64);
    out_ = {0, 1, 0, 0};  // little-endian CDR
  }

  void message(const MessageLayout& layout) {
    static const MessageLayout* const header = convert::message_layout("std_msgs/msg/Header");
    static const MessageLayout* const time = convert::message_layout("builtin_interfaces/msg/Time");
    if (&layout == header) in_.number<std::uint32_t>();  // seq
    if (&layout == time) check_time();
    for (const MessageLayout::Field& field : layout.fields) {
      const std::size_t count = field.is_sequence ? length(0) : field.count;
      if (field.size > 0) {
        numbers(count, field.size);
      } else {
        // Every message and string takes a byte at least, so this ends with the bytes.
        for (std::size_t i = 0; i < count && in_.ok(); ++i) {
          field.part != nullptr ? message(*field.part) : text();
        }
      }
      if (!in_.ok()) return;
    }
  }

  [[nodiscard]] std::string error() const {
    if (!in_.ok()) return "it is too short for its type";
    if (in_.left() > 0) return "it is too long for its type";
    return is_late_ ? "ROS 2 has no such time, after 2038" : "";
  }
  Bytes take() { return std::move(out_); }

 private:
  void check_time() {
    ByteCursor ahead = in_;
    constexpr auto kLatest = static_cast<std::uint32_t>(std::numeric_limits<std::int32_t>::max());
    if (ahead.number<std::uint32_t>() > kLatest) is_late_ = true;
  }
  void align(std::size_t size) { out_.resize(4 + (out_.size() - 4 + size - 1) / size * size); }
  void append(View bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }

  /// A length, which is written with `more` added.
  std::size_t length(std::uint32_t more) {
    const auto count = in_.number<std::uint32_t>();
    align(4);
    for (int shift = 0; shift < 32; shift += 8) {
      out_.push_back(static_cast<std::uint8_t>((count + more) >> shift));
    }
    return count;
  }
  void numbers(std::size_t count, std::size_t size) {
    if (count == 0) return;
    align(size);
    append(in_.take(static_cast<std::uint64_t>(count) * size));
  }
  /// Ends with a zero in CDR, which its length counts.
  void text() {
    append(in_.take(length(1)));
    out_.push_back(0);
  }

  ByteCursor in_;
  Bytes out_;
  bool is_late_ = false;
};

}  // namespace

std::optional<Ros1Type> find_ros1_type(std::string_view type, std::string_view md5) {
  const auto* const found = std::find_if(std::begin(kKnown), std::end(kKnown),
                                         [&](const Known& known) { return known.ros1 == type; });
  if (found == std::end(kKnown) || (md5 != "*" && md5 != found->md5)) return std::nullopt;
  return Ros1Type{std::string(found->ros2), convert::message_layout(found->ros2)};
}

std::string ros2_type_name(std::string_view type) {
  const std::size_t slash = type.find('/');
  if (slash == std::string_view::npos) return std::string(type);
  return std::string(type.substr(0, slash)) + "/msg" + std::string(type.substr(slash));
}

Bytes ros1_to_cdr(const Ros1Type& type, View message, const std::string& place) {
  Transcoder transcoder(message);
  transcoder.message(*type.layout);
  if (const std::string why = transcoder.error(); !why.empty()) {
    throw convert::Undecodable(place, "is not a valid message of ROS 1: " + why,
                               "record it again or leave it out");
  }
  return transcoder.take();
}

}  // namespace strata::log
