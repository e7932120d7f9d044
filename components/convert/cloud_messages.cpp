// SPDX-License-Identifier: Apache-2.0
#include "components/convert/cloud_messages.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include "components/convert/geometry_messages.hpp"
#include "core/base/error.hpp"

namespace strata::convert {
namespace {

// sensor_msgs/PointField's numbers.
constexpr std::uint8_t kUint8 = 2;
constexpr std::uint8_t kUint32 = 6;
constexpr std::uint8_t kFloat32 = 7;
constexpr std::uint8_t kFloat64 = 8;

struct Field {
  std::size_t offset = 0;
  std::uint8_t type = kFloat32;
};

std::size_t size_of(std::uint8_t type) {
  switch (type) {
    case kUint8:
      return 1;
    case kUint32:
    case kFloat32:
      return 4;
    case kFloat64:
      return 8;
    default:
      return 0;
  }
}

/// Nothing when there is no field of that name.
std::optional<Field> field_named(const sensor_msgs::msg::PointCloud2& message, const char* name) {
  for (const sensor_msgs::msg::PointField& field : message.fields()) {
    if (field.name() != name) continue;
    if (std::size_t{field.offset()} + size_of(field.datatype()) > message.point_step()) {
      throw InputError(std::string("PointCloud2: field ") + name, "lies outside the point",
                       "check offset and point_step");
    }
    return Field{field.offset(), field.datatype()};
  }
  return std::nullopt;
}

Field coordinate(const sensor_msgs::msg::PointCloud2& message, const char* name) {
  const auto field = field_named(message, name);
  if (!field) {
    throw InputError("PointCloud2", std::string("has no field ") + name,
                     "publish clouds with fields x, y and z");
  }
  if (field->type != kFloat32 && field->type != kFloat64) {
    throw InputError(std::string("PointCloud2: field ") + name, "is neither float32 nor float64",
                     "publish x, y and z in metres as floating-point numbers");
  }
  return *field;
}

template <typename T>
T value_at(const std::uint8_t* point, std::size_t offset) {
  T value{};
  std::memcpy(&value, point + offset, sizeof value);
  return value;
}

double number_at(const std::uint8_t* point, const Field& field) {
  switch (field.type) {
    case kUint8:
      return value_at<std::uint8_t>(point, field.offset);
    case kUint32:
      return value_at<std::uint32_t>(point, field.offset);
    case kFloat32:
      return static_cast<double>(value_at<float>(point, field.offset));
    default:
      return value_at<double>(point, field.offset);
  }
}

/// Calls visit(bytes of a point) for each, once it is sure that they are all there.
template <typename Visit>
void for_each_point(const sensor_msgs::msg::PointCloud2& message, const Visit& visit) {
  if (message.is_bigendian()) {
    throw InputError("PointCloud2", "is big-endian", "publish little-endian clouds");
  }
  const std::uint64_t width = message.width();
  const std::uint64_t height = message.height();
  if (width == 0 || height == 0) return;
  const std::uint64_t row = width * message.point_step();
  // Rows may be padded; that the last one is not is allowed.
  const bool fits =
      row <= message.row_step() && (height - 1) * message.row_step() + row <= message.data().size();
  if (!fits) {
    throw InputError("PointCloud2", "holds less data than its width, height and steps say",
                     "check what publishes it");
  }
  for (std::uint64_t y = 0; y < height; ++y) {
    const std::uint8_t* point = message.data().data() + y * message.row_step();
    for (std::uint64_t x = 0; x < width; ++x, point += message.point_step()) visit(point);
  }
}

/// The time [s] of a number of a field, after the cloud's stamp. Clocks count from 1970, in seconds
/// or, as Livox's, in nanoseconds; a sweep takes seconds: there is no doubt which of them is meant.
double offset_of(double number, std::uint8_t type, Stamp stamp) {
  if (type == kUint32) return number * 1e-9;
  if (std::abs(number) > 1e15) return (number - static_cast<double>(stamp.ns)) * 1e-9;
  return std::abs(number) > 1e6 ? number - stamp.seconds() : number;
}

}  // namespace

std::vector<Eigen::Vector3f> from_message(const sensor_msgs::msg::PointCloud2& message) {
  const std::array<Field, 3> fields{coordinate(message, "x"), coordinate(message, "y"),
                                    coordinate(message, "z")};
  std::vector<Eigen::Vector3f> points;
  points.reserve(std::min<std::uint64_t>(std::uint64_t{message.width()} * message.height(),
                                         message.data().size()));
  for_each_point(message, [&](const std::uint8_t* point) {
    points.emplace_back(static_cast<float>(number_at(point, fields[0])),
                        static_cast<float>(number_at(point, fields[1])),
                        static_cast<float>(number_at(point, fields[2])));
  });
  return points;
}

CloudColumns columns_of(const sensor_msgs::msg::PointCloud2& message) {
  CloudColumns columns;
  const Stamp stamp = from_message(message.header().stamp());
  for (const char* name : {"time", "t", "timestamp"}) {
    const auto field = field_named(message, name);
    if (!field || size_of(field->type) < 4 || !columns.offset_s.empty()) continue;
    for_each_point(message, [&](const std::uint8_t* point) {
      columns.offset_s.push_back(
          static_cast<float>(offset_of(number_at(point, *field), field->type, stamp)));
    });
  }
  const auto moving = field_named(message, "moving");
  if (moving && moving->type == kUint8) {
    for_each_point(message, [&](const std::uint8_t* point) {
      columns.truly_moving.push_back(point[moving->offset] != 0 ? 1 : 0);
    });
  }
  for (const char* name : {"rgb", "rgba"}) {
    const auto field = field_named(message, name);
    const bool is_packed = field && (field->type == kUint32 || field->type == kFloat32);
    if (!is_packed || !columns.rgb.empty()) continue;
    for_each_point(message, [&](const std::uint8_t* point) {
      // Never as a float: with alpha it is NaN, whose bits may change.
      columns.rgb.push_back(value_at<std::uint32_t>(point, field->offset) & 0xFFFFFFU);
    });
  }
  return columns;
}

sensor_msgs::msg::PointCloud2 to_message(const std::vector<Eigen::Vector3f>& points_m, Stamp stamp,
                                         const std::string& frame, const CloudColumns& columns) {
  sensor_msgs::msg::PointCloud2 message;
  message.header(make_header(stamp, frame));
  message.height(1);
  message.width(static_cast<std::uint32_t>(points_m.size()));
  const auto add_field = [&](const char* name, std::uint8_t type) {
    sensor_msgs::msg::PointField field;
    field.name(name);
    field.offset(message.point_step());
    field.datatype(type);
    field.count(1);
    message.fields().push_back(field);
    message.point_step(message.point_step() + static_cast<std::uint32_t>(size_of(type)));
  };
  for (const char* name : {"x", "y", "z"}) add_field(name, kFloat32);
  if (!columns.offset_s.empty()) add_field("time", kFloat32);
  if (!columns.truly_moving.empty()) add_field("moving", kUint8);
  if (!columns.rgb.empty()) add_field("rgb", kFloat32);
  message.row_step(message.point_step() * message.width());
  message.data().resize(std::size_t{message.point_step()} * points_m.size());
  std::uint8_t* to = message.data().data();
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    std::memcpy(to, points_m[i].data(), 12);
    to += 12;
    if (!columns.offset_s.empty()) {
      std::memcpy(to, &columns.offset_s[i], 4);
      to += 4;
    }
    if (!columns.truly_moving.empty()) *to++ = columns.truly_moving[i];
    if (!columns.rgb.empty()) {
      std::memcpy(to, &columns.rgb[i], 4);
      to += 4;
    }
  }
  return message;
}

octomap_msgs::msg::Octomap to_color_octomap(const std::string& data, double resolution_m,
                                            Stamp stamp, const std::string& frame) {
  octomap_msgs::msg::Octomap message = to_binary_octomap(data, resolution_m, stamp, frame);
  message.binary(false);
  message.id("ColorOcTree");
  return message;
}

octomap_msgs::msg::Octomap to_binary_octomap(const std::string& data, double resolution_m,
                                             Stamp stamp, const std::string& frame) {
  octomap_msgs::msg::Octomap message;
  message.header(make_header(stamp, frame));
  message.binary(true);
  message.id("OcTree");
  message.resolution(resolution_m);
  message.data().assign(data.begin(), data.end());
  return message;
}

}  // namespace strata::convert
