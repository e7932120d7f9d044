// SPDX-License-Identifier: Apache-2.0
#include "components/convert/cloud_messages.hpp"

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>

#include "components/convert/geometry_messages.hpp"
#include "core/base/error.hpp"

namespace strata::convert {
namespace {

// sensor_msgs/PointField's numbers.
constexpr std::uint8_t kFloat32 = 7;
constexpr std::uint8_t kFloat64 = 8;

struct Field {
  std::size_t offset = 0;
  bool is_double = false;
};

Field find_field(const sensor_msgs::msg::PointCloud2& message, const char* name) {
  for (const sensor_msgs::msg::PointField& field : message.fields()) {
    if (field.name() != name) continue;
    const bool is_double = field.datatype() == kFloat64;
    if (!is_double && field.datatype() != kFloat32) {
      throw InputError(std::string("PointCloud2: field ") + name, "is neither float32 nor float64",
                       "publish x, y and z in metres as floating-point numbers");
    }
    const std::size_t end = std::size_t{field.offset()} + (is_double ? 8 : 4);
    if (end > message.point_step()) {
      throw InputError(std::string("PointCloud2: field ") + name, "lies outside the point",
                       "check offset and point_step");
    }
    return {field.offset(), is_double};
  }
  throw InputError("PointCloud2", std::string("has no field ") + name,
                   "publish clouds with fields x, y and z");
}

float number_at(const std::uint8_t* point, const Field& field) {
  if (field.is_double) {
    double value = 0.0;
    std::memcpy(&value, point + field.offset, sizeof value);
    return static_cast<float>(value);
  }
  float value = 0.0F;
  std::memcpy(&value, point + field.offset, sizeof value);
  return value;
}

}  // namespace

std::vector<Eigen::Vector3f> from_message(const sensor_msgs::msg::PointCloud2& message) {
  if (message.is_bigendian()) {
    throw InputError("PointCloud2", "is big-endian", "publish little-endian clouds");
  }
  const std::array<Field, 3> fields{find_field(message, "x"), find_field(message, "y"),
                                    find_field(message, "z")};
  const std::uint64_t width = message.width();
  const std::uint64_t height = message.height();
  const std::uint64_t row = width * message.point_step();
  // Rows may be padded; that the last one is not is allowed.
  const bool fits =
      row <= message.row_step() &&
      (height == 0 || (height - 1) * message.row_step() + row <= message.data().size());
  if (width > 0 && height > 0 && !fits) {
    throw InputError("PointCloud2", "holds less data than its width, height and steps say",
                     "check what publishes it");
  }
  std::vector<Eigen::Vector3f> points;
  if (width == 0 || height == 0) return points;
  points.reserve(width * height);
  for (std::uint64_t y = 0; y < height; ++y) {
    const std::uint8_t* point = message.data().data() + y * message.row_step();
    for (std::uint64_t x = 0; x < width; ++x, point += message.point_step()) {
      points.emplace_back(number_at(point, fields[0]), number_at(point, fields[1]),
                          number_at(point, fields[2]));
    }
  }
  return points;
}

sensor_msgs::msg::PointCloud2 to_message(const std::vector<Eigen::Vector3f>& points_m, Stamp stamp,
                                         const std::string& frame) {
  sensor_msgs::msg::PointCloud2 message;
  message.header(make_header(stamp, frame));
  message.height(1);
  message.width(static_cast<std::uint32_t>(points_m.size()));
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z"}) {
    sensor_msgs::msg::PointField field;
    field.name(name);
    field.offset(offset);
    field.datatype(kFloat32);
    field.count(1);
    message.fields().push_back(field);
    offset += 4;
  }
  message.point_step(12);
  message.row_step(12 * message.width());
  message.data().resize(12 * points_m.size());
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    std::memcpy(message.data().data() + 12 * i, points_m[i].data(), 12);
  }
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
