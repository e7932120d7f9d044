// SPDX-License-Identifier: Apache-2.0
#include "components/convert/cloud_messages.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "core/base/error.hpp"

namespace strata::convert {
namespace {

using sensor_msgs::msg::PointCloud2;

const std::vector<Eigen::Vector3f> kPoints{{1.0F, 2.0F, 3.0F}, {-0.5F, 0.25F, 1e-3F}};

TEST(CloudMessages, KeepTheBitsOfEveryPointThroughCdr) {
  const PointCloud2 sent = to_message(kPoints, Stamp::from_seconds(2.5), "lidar");
  const auto bytes = to_cdr(sent);
  EXPECT_EQ(from_message(from_cdr<PointCloud2>(bytes, "test")), kPoints);
}

TEST(CloudMessages, FindFieldsWhereverTheyLieWithPaddedRows) {
  PointCloud2 cloud = to_message({}, Stamp{}, "lidar");
  cloud.fields()[0].offset(8);  // x float32 behind z float64
  cloud.fields()[1].offset(12);
  cloud.fields()[2].offset(0);
  cloud.fields()[2].datatype(8);
  cloud.point_step(20);
  cloud.row_step(24);
  cloud.width(1);
  cloud.height(2);
  cloud.data().assign(24 + 20, 0);  // the last row without its padding
  for (int row = 0; row < 2; ++row) {
    const float x = 1.0F + static_cast<float>(row);
    const float y = 5.0F;
    const double z = -2.0;
    std::uint8_t* point = cloud.data().data() + 24 * row;
    std::memcpy(point, &z, 8);
    std::memcpy(point + 8, &x, 4);
    std::memcpy(point + 12, &y, 4);
  }
  const std::vector<Eigen::Vector3f> expected{{1.0F, 5.0F, -2.0F}, {2.0F, 5.0F, -2.0F}};
  EXPECT_EQ(from_message(cloud), expected);
}

TEST(CloudMessages, LeaveNanToTheMap) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto points = from_message(to_message({{nan, 0.0F, 0.0F}}, Stamp{}, "lidar"));
  EXPECT_TRUE(std::isnan(points.at(0).x()));
}

TEST(CloudMessages, RefuseCloudsThatDoNotFitTogether) {
  const PointCloud2 good = to_message(kPoints, Stamp{}, "lidar");
  const auto refused = [&](auto spoil) {
    PointCloud2 cloud = good;
    spoil(cloud);
    EXPECT_THROW((void)from_message(cloud), InputError);
  };
  refused([](PointCloud2& c) { c.fields().clear(); });
  refused([](PointCloud2& c) { c.fields()[2].name("intensity"); });
  refused([](PointCloud2& c) { c.fields()[0].datatype(4); });
  refused([](PointCloud2& c) { c.fields()[0].offset(10); });
  refused([](PointCloud2& c) { c.fields()[0].offset(0xFFFFFFFFU); });
  refused([](PointCloud2& c) { c.is_bigendian(true); });
  refused([](PointCloud2& c) { c.width(3); });
  refused([](PointCloud2& c) { c.height(0xFFFFFFFFU); });
  refused([](PointCloud2& c) { c.row_step(0); });
  refused([](PointCloud2& c) { c.data().pop_back(); });
  EXPECT_TRUE(from_message(to_message({}, Stamp{}, "lidar")).empty());
}

TEST(CloudMessages, MakeTheBinaryFormOfOctomapMessages) {
  const auto message = to_binary_octomap(std::string("\x01\xFF\x00", 3), 0.05, Stamp{}, "map");
  EXPECT_TRUE(message.binary());
  EXPECT_EQ(message.id(), "OcTree");
  EXPECT_EQ(message.resolution(), 0.05);
  EXPECT_EQ(message.data(), (std::vector<std::int8_t>{1, -1, 0}));
}

}  // namespace
}  // namespace strata::convert
