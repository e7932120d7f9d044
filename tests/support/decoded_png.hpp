// SPDX-License-Identifier: Apache-2.0
/// The pixels of a PNG file.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <png.h>

#include "tools/report/image.hpp"

namespace strata::test {

inline report::Image decode(const std::string& bytes) {
  png_image header;
  std::memset(&header, 0, sizeof header);
  header.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()), 0);
  header.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(header));
  EXPECT_NE(png_image_finish_read(&header, nullptr, pixels.data(), 0, nullptr), 0);
  report::Image image(static_cast<int>(header.width), static_cast<int>(header.height));
  for (int i = 0; i < image.width() * image.height(); ++i) {
    const auto at = static_cast<std::size_t>(3 * i);
    image.set(i % image.width(), i / image.width(), {pixels[at], pixels[at + 1], pixels[at + 2]});
  }
  return image;
}

}  // namespace strata::test
