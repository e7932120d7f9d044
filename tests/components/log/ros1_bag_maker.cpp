// SPDX-License-Identifier: Apache-2.0
#include "tests/components/log/ros1_bag_maker.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include <bzlib.h>
#include <lz4frame.h>

#include "components/convert/cdr.hpp"
#include "components/log/bag.hpp"

namespace strata::log::test_log {
namespace {

std::string op_field(std::uint8_t code) { return std::string(1, static_cast<char>(code)); }
std::string le32(std::uint32_t value) { return Ros1Bytes().u32(value).bytes(); }
std::string le64(std::uint64_t value) { return Ros1Bytes().u64(value).bytes(); }

std::string record(const Ros1Bytes& header, const std::string& data) {
  return Ros1Bytes().text(header.bytes()).text(data).bytes();
}

/// Seconds in the first four bytes, nanoseconds in the others.
std::uint64_t ros1_time(Stamp stamp) {
  const auto ns = static_cast<std::uint64_t>(stamp.ns);
  return (ns / 1'000'000'000) | (ns % 1'000'000'000) << 32;
}
Stamp stamp_of(std::uint64_t time) {
  return {static_cast<std::int64_t>((time & 0xFFFFFFFF) * 1'000'000'000 + (time >> 32))};
}

std::string bz2(const std::string& plain) {
  std::string packed(plain.size() + plain.size() / 50 + 1000, '\0');
  auto size = static_cast<unsigned>(packed.size());
  const int code = BZ2_bzBuffToBuffCompress(packed.data(), &size, const_cast<char*>(plain.data()),
                                            static_cast<unsigned>(plain.size()), 9, 0, 0);
  if (code != BZ_OK) throw std::runtime_error("bzip2");
  packed.resize(size);
  return packed;
}

/// As ROS 1's roslz4 has it: independent blocks, a checksum of the content.
std::string lz4(const std::string& plain) {
  LZ4F_preferences_t preferences{};
  preferences.frameInfo.blockMode = LZ4F_blockIndependent;
  preferences.frameInfo.blockSizeID = LZ4F_max64KB;
  preferences.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  std::string packed(LZ4F_compressFrameBound(plain.size(), &preferences), '\0');
  const std::size_t size =
      LZ4F_compressFrame(packed.data(), packed.size(), plain.data(), plain.size(), &preferences);
  if (LZ4F_isError(size) != 0U) throw std::runtime_error("lz4");
  packed.resize(size);
  return packed;
}

template <typename Header>
Ros1Bytes& put_header(Ros1Bytes& bytes, const Header& header, std::uint32_t seq) {
  return bytes.u32(seq)
      .u32(static_cast<std::uint32_t>(header.stamp().sec()))
      .u32(header.stamp().nanosec())
      .text(header.frame_id());
}

template <typename Vector>
void put_xyz(Ros1Bytes& bytes, const Vector& vector) {
  bytes.f64(vector.x()).f64(vector.y()).f64(vector.z());
}

void put_rotation(Ros1Bytes& bytes, const geometry_msgs::msg::Quaternion& rotation) {
  bytes.f64(rotation.x()).f64(rotation.y()).f64(rotation.z()).f64(rotation.w());
}

}  // namespace

const Ros1Topic kRos1Scan{"/scan", "sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369"};
const Ros1Topic kRos1Odometry{"/odom", "nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7"};
const Ros1Topic kRos1Transforms{"/tf", "tf2_msgs/TFMessage", "94810edda583a504dfda3829e70d7eec"};
const Ros1Topic kRos1OldTransforms{"/tf", "tf/tfMessage", "94810edda583a504dfda3829e70d7eec"};
const Ros1Topic kRos1FixedTransforms{"/tf_static", "tf2_msgs/TFMessage",
                                     "94810edda583a504dfda3829e70d7eec", true};
const Ros1Topic kRos1Truth{"/ground_truth", "geometry_msgs/PoseStamped",
                           "d3812c3cbc69362b77dc0b19b345f8f5"};
const Ros1Topic kRos1Cloud{"/points", "sensor_msgs/PointCloud2",
                           "1158d486dd51d683ce2f1be655c3c181"};
const Ros1Topic kRos1Chat{"/chat", "std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1"};

Ros1Bytes& Ros1Bytes::f32(float value) { return u32(std::bit_cast<std::uint32_t>(value)); }
Ros1Bytes& Ros1Bytes::f64(double value) { return u64(std::bit_cast<std::uint64_t>(value)); }
Ros1Bytes& Ros1Bytes::raw(std::string_view bytes) {
  bytes_ += bytes;
  return *this;
}
Ros1Bytes& Ros1Bytes::field(std::string_view name, std::string_view value) {
  return text(std::string(name) + "=" + std::string(value));
}
Ros1Bytes& Ros1Bytes::number(std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes_ += static_cast<char>(value >> (8 * i));
  return *this;
}

std::string ros1_message(const sensor_msgs::msg::LaserScan& scan, std::uint32_t seq) {
  Ros1Bytes bytes;
  put_header(bytes, scan.header(), seq);
  bytes.f32(scan.angle_min()).f32(scan.angle_max()).f32(scan.angle_increment());
  bytes.f32(scan.time_increment()).f32(scan.scan_time());
  bytes.f32(scan.range_min()).f32(scan.range_max());
  bytes.u32(static_cast<std::uint32_t>(scan.ranges().size()));
  for (const float range : scan.ranges()) bytes.f32(range);
  bytes.u32(static_cast<std::uint32_t>(scan.intensities().size()));
  for (const float intensity : scan.intensities()) bytes.f32(intensity);
  return bytes.bytes();
}

std::string ros1_message(const sensor_msgs::msg::PointCloud2& cloud, std::uint32_t seq) {
  Ros1Bytes bytes;
  put_header(bytes, cloud.header(), seq).u32(cloud.height()).u32(cloud.width());
  bytes.u32(static_cast<std::uint32_t>(cloud.fields().size()));
  for (const auto& field : cloud.fields()) {
    bytes.text(field.name()).u32(field.offset()).u8(field.datatype()).u32(field.count());
  }
  bytes.u8(cloud.is_bigendian() ? 1 : 0).u32(cloud.point_step()).u32(cloud.row_step());
  bytes.text({reinterpret_cast<const char*>(cloud.data().data()), cloud.data().size()});
  return bytes.u8(cloud.is_dense() ? 1 : 0).bytes();
}

std::string ros1_message(const nav_msgs::msg::Odometry& odometry, std::uint32_t seq) {
  Ros1Bytes bytes;
  put_header(bytes, odometry.header(), seq).text(odometry.child_frame_id());
  put_xyz(bytes, odometry.pose().pose().position());
  put_rotation(bytes, odometry.pose().pose().orientation());
  for (const double value : odometry.pose().covariance()) bytes.f64(value);
  put_xyz(bytes, odometry.twist().twist().linear());
  put_xyz(bytes, odometry.twist().twist().angular());
  for (const double value : odometry.twist().covariance()) bytes.f64(value);
  return bytes.bytes();
}

std::string ros1_message(const tf2_msgs::msg::TFMessage& transforms, std::uint32_t seq) {
  Ros1Bytes bytes;
  bytes.u32(static_cast<std::uint32_t>(transforms.transforms().size()));
  for (const auto& transform : transforms.transforms()) {
    put_header(bytes, transform.header(), seq).text(transform.child_frame_id());
    put_xyz(bytes, transform.transform().translation());
    put_rotation(bytes, transform.transform().rotation());
  }
  return bytes.bytes();
}

std::string ros1_message(const geometry_msgs::msg::PoseStamped& pose, std::uint32_t seq) {
  Ros1Bytes bytes;
  put_header(bytes, pose.header(), seq);
  put_xyz(bytes, pose.pose().position());
  put_rotation(bytes, pose.pose().orientation());
  return bytes.bytes();
}

void Ros1BagMaker::write(const Ros1Topic& topic, Stamp stamp, const std::string& message) {
  const auto found = std::find_if(topics_.begin(), topics_.end(), [&](const Ros1Topic& known) {
    return known.name == topic.name && known.type == topic.type;
  });
  const auto id = static_cast<std::uint32_t>(found - topics_.begin());
  if (found == topics_.end()) {
    topics_.push_back(topic);
    records_ += connection(id);
  }
  const std::uint64_t time = ros1_time(stamp);
  chunk_.entries[id].emplace_back(time, static_cast<std::uint32_t>(records_.size()));
  const bool is_first = chunk_.end == 0;
  chunk_.begin = is_first || stamp < stamp_of(chunk_.begin) ? time : chunk_.begin;
  chunk_.end = is_first || stamp_of(chunk_.end) < stamp ? time : chunk_.end;
  records_ +=
      record(Ros1Bytes().field("op", op_field(2)).field("conn", le32(id)).field("time", le64(time)),
             message);
  if (records_.size() >= format_.chunk_bytes) finish_chunk(true);
}

void Ros1BagMaker::finish_chunk(bool with_lengths) {
  if (records_.empty()) return;
  const std::string data = format_.compression == "bz2"   ? bz2(records_)
                           : format_.compression == "lz4" ? lz4(records_)
                                                          : records_;
  chunk_.position = kRos1FirstChunk + file_.size();
  const Ros1Bytes header = Ros1Bytes()
                               .field("op", op_field(5))
                               .field("compression", format_.compression)
                               .field("size", le32(with_lengths ? Ros1Bytes::length(records_) : 0));
  file_ += with_lengths ? record(header, data) : record(header, "") + data;
  if (with_lengths) {
    for (const auto& [id, entries] : chunk_.entries) {
      Ros1Bytes places;
      for (const auto& [time, place] : entries) places.u64(time).u32(place);
      const auto count = static_cast<std::uint32_t>(entries.size());
      const Ros1Bytes index = Ros1Bytes()
                                  .field("op", op_field(4))
                                  .field("ver", le32(1))
                                  .field("conn", le32(id))
                                  .field("count", le32(count));
      if (format_.end != Ros1End::kWhole) continue;
      file_ += Ros1Bytes().text(index.bytes()).u32(format_.stated_entry_bytes * count).bytes();
      file_ += places.bytes();
    }
  }
  chunks_.push_back(std::exchange(chunk_, {}));
  records_.clear();
}

std::string Ros1BagMaker::connection(std::uint32_t id) const {
  const Ros1Topic& topic = topics_.at(id);
  Ros1Bytes about;
  about.field("topic", topic.name).field("type", topic.type).field("md5sum", topic.md5);
  about.field("message_definition", "# not looked at\n");
  if (topic.latched) about.field("latching", "1");
  return record(
      Ros1Bytes().field("op", op_field(7)).field("conn", le32(id)).field("topic", topic.name),
      about.bytes());
}

std::string Ros1BagMaker::bag_header(std::uint64_t index_at) const {
  const bool is_whole = format_.end == Ros1End::kWhole;
  const auto number = [&](std::size_t count) {
    return le32(is_whole ? static_cast<std::uint32_t>(count) : 0);
  };
  const Ros1Bytes header = Ros1Bytes()
                               .field("op", op_field(3))
                               .field("index_pos", le64(is_whole ? index_at : 0))
                               .field("conn_count", number(topics_.size()))
                               .field("chunk_count", number(chunks_.size()));
  return record(header, std::string(4096 - header.bytes().size(), ' '));
}

std::string Ros1BagMaker::finish() {
  finish_chunk(format_.end != Ros1End::kUnfinishedChunk);
  const std::uint64_t index_at = kRos1FirstChunk + file_.size();
  if (format_.end == Ros1End::kWhole) {
    for (std::uint32_t id = 0; id < topics_.size(); ++id) file_ += connection(id);
    for (const Chunk& chunk : chunks_) {
      Ros1Bytes counts;
      for (const auto& [id, entries] : chunk.entries) {
        counts.u32(id).u32(static_cast<std::uint32_t>(entries.size()));
      }
      file_ += record(Ros1Bytes()
                          .field("op", op_field(6))
                          .field("ver", le32(1))
                          .field("chunk_pos", le64(chunk.position))
                          .field("start_time", le64(chunk.begin))
                          .field("end_time", le64(chunk.end))
                          .field("count", le32(static_cast<std::uint32_t>(chunk.entries.size()))),
                      counts.bytes());
    }
  }
  return "#ROSBAG V2.0\n" + bag_header(index_at) + file_;
}

std::string ros1_bag_of(const std::filesystem::path& rosbag2, const Ros1Format& format) {
  const auto reader = BagReader::open(rosbag2);
  Ros1BagMaker maker(format);
  BagMessage message;
  std::uint32_t seq = 0;
  while (reader->next(message)) {
    const BagTopic& from = reader->topics()[message.topic];
    const auto write = [&]<typename Message>(Ros1Topic topic, const Message&) {
      topic.name = from.name;
      const auto decoded = convert::from_cdr<Message>(message.data, from.name);
      maker.write(topic, message.stamp, ros1_message(decoded, seq++));
    };
    if (from.type == "sensor_msgs/msg/LaserScan") {
      write(kRos1Scan, sensor_msgs::msg::LaserScan());
    } else if (from.type == "sensor_msgs/msg/PointCloud2") {
      write(kRos1Cloud, sensor_msgs::msg::PointCloud2());
    } else if (from.type == "nav_msgs/msg/Odometry") {
      write(kRos1Odometry, nav_msgs::msg::Odometry());
    } else if (from.type == "tf2_msgs/msg/TFMessage") {
      write(from.name == "/tf_static" ? kRos1FixedTransforms : kRos1Transforms,
            tf2_msgs::msg::TFMessage());
    } else if (from.type == "geometry_msgs/msg/PoseStamped") {
      write(kRos1Truth, geometry_msgs::msg::PoseStamped());
    }
  }
  return maker.finish();
}

}  // namespace strata::log::test_log
