// SPDX-License-Identifier: Apache-2.0
#include "tools/report/image.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include <png.h>

#include "core/base/error.hpp"

namespace strata::report {

static_assert(sizeof(Color) == 3, "libpng reads the pixels as they lie");

Image::Image(int width, int height, Color fill)
    : width_(width),
      height_(height),
      pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill) {}

void Image::set(int x, int y, Color color) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
  pixels_[index(x, y)] = color;
}

void Image::dot(int x, int y, int radius, Color color) {
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) set(x + dx, y + dy, color);
  }
}

void Image::line(int x0, int y0, int x1, int y1, Color color) {
  const int steps = std::max({std::abs(x1 - x0), std::abs(y1 - y0), 1});
  for (int i = 0; i <= steps; ++i) {
    set(x0 + (x1 - x0) * i / steps, y0 + (y1 - y0) * i / steps, color);
  }
}

void Image::frame(int x0, int y0, int x1, int y1, Color color) {
  line(x0, y0, x1, y0, color);
  line(x0, y1, x1, y1, color);
  line(x0, y0, x0, y1, color);
  line(x1, y0, x1, y1, color);
}

void Image::paste(const Image& other, int x, int y) {
  for (int row = 0; row < other.height(); ++row) {
    for (int column = 0; column < other.width(); ++column) {
      set(x + column, y + row, other.at(column, row));
    }
  }
}

std::string encode_png(const Image& image) {
  png_image header;
  std::memset(&header, 0, sizeof header);
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width());
  header.height = static_cast<png_uint_32>(image.height());
  header.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  const auto fail = [&header]() -> OutputError {
    return {"picture", std::string("cannot be encoded: ") + header.message, "free some memory"};
  };
  if (png_image_write_to_memory(&header, nullptr, &size, 0, image.pixels().data(), 0, nullptr) ==
      0) {
    throw fail();
  }
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0, image.pixels().data(), 0,
                                nullptr) == 0) {
    throw fail();
  }
  bytes.resize(size);
  return bytes;
}

void write_file(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream out(path, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) {
    throw OutputError(path.string(), "cannot be written", "check the folder and the free space");
  }
}

}  // namespace strata::report
