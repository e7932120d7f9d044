// SPDX-License-Identifier: Apache-2.0
#include "components/clouds/image_messages.hpp"

#include <cstring>

#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "components/convert/cloud_messages.hpp"
#include "core/base/error.hpp"

namespace strata::convert {
namespace {

using sensor_msgs::msg::CameraInfo;
using sensor_msgs::msg::Image;
using volume::Rgb;

const volume::ColorImage kImage{2, 2, {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {250, 251, 252}}};

TEST(ImageMessages, KeepEveryPixelThroughCdr) {
  const auto bytes = to_cdr(to_message(kImage, Stamp::from_seconds(2.5), "camera"));
  const volume::ColorImage back = from_message(from_cdr<Image>(bytes, "test"));
  EXPECT_EQ(back.width, 2);
  EXPECT_EQ(back.pixels, kImage.pixels);
}

TEST(ImageMessages, ReadTheOrdersOfColoursThatDriversSend) {
  Image image = to_message(kImage, Stamp{}, "camera");
  image.encoding("bgr8");
  EXPECT_EQ(from_message(image).at(1, 0), (Rgb{6, 5, 4}));
  image.encoding("mono8");
  EXPECT_EQ(from_message(image).at(1, 0), (Rgb{2, 2, 2}));
  image.encoding("bgra8");
  image.step(9);  // a padded row
  image.height(1);
  EXPECT_EQ(from_message(image).at(1, 0), (Rgb{7, 6, 5}));
}

TEST(ImageMessages, RefuseWhatTheyCannotRead) {
  const Image good = to_message(kImage, Stamp{}, "camera");
  const auto refused = [&](auto spoil) {
    Image bad = good;
    spoil(bad);
    EXPECT_THROW((void)from_message(bad), InputError);
  };
  refused([](Image& image) { image.encoding("bayer_rggb8"); });
  refused([](Image& image) { image.data().pop_back(); });
  refused([](Image& image) { image.step(5); });
  refused([](Image& image) { image.height(0); });
  refused([](Image& image) { image.width(4000000000U); });
}

TEST(ImageMessages, KeepTheCalibration) {
  volume::Camera camera{640, 480, 500.0, 510.0, 319.5, 239.5, {-0.3, 0.1, 1e-3, -2e-3, 0.01}};
  const auto bytes = to_cdr(to_message(camera, Stamp{}, "camera"));
  const volume::Camera back = from_message(from_cdr<CameraInfo>(bytes, "test"));
  EXPECT_EQ(back.width, 640);
  EXPECT_EQ(back.height, 480);
  EXPECT_EQ(back.focal_x, 500.0);
  EXPECT_EQ(back.focal_y, 510.0);
  EXPECT_EQ(back.middle_x, 319.5);
  EXPECT_EQ(back.middle_y, 239.5);
  EXPECT_EQ(back.distortion, camera.distortion);
}

TEST(ImageMessages, RefuseWhatIsNoCalibration) {
  const volume::Camera camera{640, 480, 500.0, 500.0, 320.0, 240.0, {-0.3}};
  const auto refused = [&](auto spoil) {
    CameraInfo bad = to_message(camera, Stamp{}, "camera");
    spoil(bad);
    EXPECT_THROW((void)from_message(bad), InputError);
  };
  refused([](CameraInfo& info) { info.k()[0] = 0.0; });
  refused([](CameraInfo& info) { info.distortion_model("equidistant"); });
  refused([](CameraInfo& info) { info.binning_x(2); });
  CameraInfo undistorted =
      to_message(volume::Camera{640, 480, 500.0, 500.0, 320.0, 240.0, {}}, Stamp{}, "camera");
  undistorted.distortion_model("");
  EXPECT_EQ(from_message(undistorted).distortion[0], 0.0);
}

TEST(CloudMessages, SayWhenEachPointWasMeasured) {
  const std::vector<Eigen::Vector3f> points{{1.0F, 2.0F, 3.0F}, {4.0F, 5.0F, 6.0F}};
  const Stamp stamp = Stamp::from_seconds(1.7e9);
  auto message = to_message(points, stamp, "lidar", {{0.0F, 0.25F}, {1, 0}});
  EXPECT_EQ(from_message(message), points);
  CloudColumns columns = columns_of(message);
  EXPECT_EQ(columns.offset_s, (std::vector<float>{0.0F, 0.25F}));
  EXPECT_EQ(columns.truly_moving, (std::vector<std::uint8_t>{1, 0}));
  // Nanoseconds, as Ouster counts; the bits of the floats are those of integers.
  message.fields()[3].name("t");
  message.fields()[3].datatype(6);
  const std::uint32_t ns = 250'000'000;
  std::memcpy(message.data().data() + message.point_step() + 12, &ns, 4);
  EXPECT_EQ(columns_of(message).offset_s, (std::vector<float>{0.0F, 0.25F}));
  EXPECT_TRUE(columns_of(to_message(points, stamp, "lidar")).offset_s.empty());
  message.fields()[3].offset(14);
  EXPECT_THROW((void)columns_of(message), InputError);
}

TEST(CloudMessages, TellColoursAsPclPacksThem) {
  const std::vector<Eigen::Vector3f> points{{1.0F, 2.0F, 3.0F}, {4.0F, 5.0F, 6.0F}};
  CloudColumns columns;
  columns.rgb = {0x112233, 0xFFFFFF};
  auto message = to_message(points, Stamp::from_seconds(1.0), "camera", columns);
  ASSERT_EQ(message.fields().size(), 4U);
  EXPECT_EQ(message.fields()[3].name(), "rgb");
  EXPECT_EQ(message.fields()[3].datatype(), 7) << "the bits of a float32";
  // Little-endian: blue first.
  EXPECT_EQ(message.data()[12], 0x33);
  EXPECT_EQ(message.data()[14], 0x11);
  EXPECT_EQ(from_message(message), points);
  EXPECT_EQ(columns_of(message).rgb, columns.rgb);
  // With alpha the float is NaN.
  message.fields()[3].name("rgba");
  message.data()[15] = 0xFF;
  EXPECT_EQ(columns_of(message).rgb, columns.rgb);
  message.fields()[3].datatype(6);
  EXPECT_EQ(columns_of(message).rgb, columns.rgb);
  message.fields()[3].datatype(2);
  EXPECT_TRUE(columns_of(message).rgb.empty()) << "no colour fits a byte";
  message.fields()[3].datatype(6);
  message.fields()[3].offset(13);
  EXPECT_THROW((void)columns_of(message), InputError);
}

TEST(CloudMessages, TakeATimeThatOnlyFitsAClockForOne) {
  auto message = to_message({{1.0F, 2.0F, 3.0F}}, Stamp::from_seconds(1.7e9), "lidar");
  sensor_msgs::msg::PointField field;
  field.name("timestamp");
  field.offset(12);
  field.datatype(8);
  field.count(1);
  message.fields().push_back(field);
  message.point_step(20);
  message.row_step(20);
  message.data().resize(20);
  const double clock_s = 1.7e9 + 0.5;
  std::memcpy(message.data().data() + 12, &clock_s, 8);
  EXPECT_EQ(columns_of(message).offset_s, std::vector<float>{0.5F});
  const double clock_ns = 1.7e18 + 5e7;  // as Livox's driver tells it
  std::memcpy(message.data().data() + 12, &clock_ns, 8);
  EXPECT_NEAR(columns_of(message).offset_s.at(0), 0.05, 1e-6);
}

}  // namespace
}  // namespace strata::convert
