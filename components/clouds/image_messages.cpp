// SPDX-License-Identifier: Apache-2.0
#include "components/clouds/image_messages.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "components/convert/geometry_messages.hpp"
#include "core/base/error.hpp"

namespace strata::convert {
namespace {

/// Where the colours of a pixel lie in its bytes.
struct PixelLayout {
  std::size_t bytes = 1;
  std::size_t r = 0;
  std::size_t g = 0;
  std::size_t b = 0;
};

std::optional<PixelLayout> layout_of(const std::string& encoding) {
  if (encoding == "rgb8") return PixelLayout{3, 0, 1, 2};
  if (encoding == "bgr8") return PixelLayout{3, 2, 1, 0};
  if (encoding == "rgba8") return PixelLayout{4, 0, 1, 2};
  if (encoding == "bgra8") return PixelLayout{4, 2, 1, 0};
  if (encoding == "mono8") return PixelLayout{};
  return std::nullopt;
}

}  // namespace

volume::ColorImage from_message(const sensor_msgs::msg::Image& message) {
  const auto layout = layout_of(message.encoding());
  if (!layout) {
    throw InputError("Image", "has the encoding '" + message.encoding() + "'",
                     "publish rgb8, bgr8, rgba8, bgra8 or mono8");
  }
  const std::uint64_t row = std::uint64_t{message.width()} * layout->bytes;
  const std::uint64_t height = message.height();
  const bool fits = row > 0 && height > 0 && row <= message.step() && message.width() <= 65535 &&
                    height <= 65535 && (height - 1) * message.step() + row <= message.data().size();
  if (!fits) {
    throw InputError("Image", "holds less data than its width, height and step say",
                     "check what publishes it");
  }
  volume::ColorImage image;
  image.width = static_cast<int>(message.width());
  image.height = static_cast<int>(height);
  image.pixels.reserve(message.width() * height);
  for (std::uint64_t y = 0; y < height; ++y) {
    const std::uint8_t* pixel = message.data().data() + y * message.step();
    for (std::uint32_t x = 0; x < message.width(); ++x, pixel += layout->bytes) {
      image.pixels.push_back({pixel[layout->r], pixel[layout->g], pixel[layout->b]});
    }
  }
  return image;
}

sensor_msgs::msg::Image to_message(const volume::ColorImage& image, Stamp stamp,
                                   const std::string& frame) {
  sensor_msgs::msg::Image message;
  message.header(make_header(stamp, frame));
  message.width(static_cast<std::uint32_t>(image.width));
  message.height(static_cast<std::uint32_t>(image.height));
  message.encoding("rgb8");
  message.step(3 * message.width());
  message.data().reserve(3 * image.pixels.size());
  for (const volume::Rgb& pixel : image.pixels) {
    for (const std::uint8_t value : {pixel.r, pixel.g, pixel.b}) message.data().push_back(value);
  }
  return message;
}

volume::Camera from_message(const sensor_msgs::msg::CameraInfo& message) {
  const std::string& model = message.distortion_model();
  const std::vector<double>& d = message.d();
  const bool has_distortion =
      std::any_of(d.begin(), d.end(), [](double value) { return value != 0.0; });
  if (has_distortion && model != "plumb_bob" && model != "rational_polynomial") {
    throw InputError("CameraInfo", "has the distortion model '" + model + "'",
                     "calibrate with plumb_bob or rational_polynomial, or publish rectified "
                     "pictures without d");
  }
  const bool is_whole = message.binning_x() <= 1 && message.binning_y() <= 1 &&
                        message.roi().width() == 0 && message.roi().height() == 0;
  if (!is_whole) {
    throw InputError("CameraInfo", "has binning or a region of interest", "publish whole pictures");
  }
  volume::Camera camera;
  camera.width = static_cast<int>(std::min(message.width(), 65535U));
  camera.height = static_cast<int>(std::min(message.height(), 65535U));
  camera.focal_x = message.k()[0];
  camera.middle_x = message.k()[2];
  camera.focal_y = message.k()[4];
  camera.middle_y = message.k()[5];
  const std::size_t count = std::min(d.size(), camera.distortion.size());
  if (has_distortion) std::copy_n(d.begin(), count, camera.distortion.begin());
  bool is_finite = std::isfinite(camera.middle_x) && std::isfinite(camera.middle_y) &&
                   std::isfinite(camera.focal_x) && std::isfinite(camera.focal_y);
  for (const double value : camera.distortion) is_finite = is_finite && std::isfinite(value);
  if (!is_finite || camera.focal_x <= 0.0 || camera.focal_y <= 0.0) {
    throw InputError("CameraInfo", "is not a calibration: no positive focal length",
                     "calibrate the camera");
  }
  return camera;
}

sensor_msgs::msg::CameraInfo to_message(const volume::Camera& camera, Stamp stamp,
                                        const std::string& frame) {
  sensor_msgs::msg::CameraInfo message;
  message.header(make_header(stamp, frame));
  message.width(static_cast<std::uint32_t>(camera.width));
  message.height(static_cast<std::uint32_t>(camera.height));
  message.distortion_model("rational_polynomial");
  message.d().assign(camera.distortion.begin(), camera.distortion.end());
  message.k() = {
      camera.focal_x, 0.0, camera.middle_x, 0.0, camera.focal_y, camera.middle_y, 0.0, 0.0, 1.0};
  message.r() = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  message.p() = {camera.focal_x,
                 0.0,
                 camera.middle_x,
                 0.0,
                 0.0,
                 camera.focal_y,
                 camera.middle_y,
                 0.0,
                 0.0,
                 0.0,
                 1.0,
                 0.0};
  return message;
}

}  // namespace strata::convert
