// SPDX-License-Identifier: Apache-2.0
#include "components/log/map_image.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>

#include <png.h>

#include "components/log/map_bmp.hpp"
#include "components/log/whole_file.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

constexpr int kLargestSide = 50'000;
/// A PNG may promise far more than it has bytes.
constexpr std::size_t kMaxPngPixels = 100'000'000;

using Refuse = std::function<InputError(const std::string&)>;

/// The next number of a PGM header, behind blanks and comments; -1 when there is none.
int header_number(std::istream& in) {
  int c = in.get();
  while (c == '#' || std::isspace(c) != 0) {
    if (c == '#') {
      while (c != '\n' && c != EOF) c = in.get();
    }
    c = in.get();
  }
  if (std::isdigit(c) == 0) return -1;
  int value = 0;
  for (; std::isdigit(c) != 0; c = in.get()) value = std::min(1'000'000, value * 10 + (c - '0'));
  return value;  // the one blank behind it is taken too, as the format wants
}

/// in: behind the two letters. file_size: in bytes.
MapImage read_pgm(std::istream& in, bool is_binary, std::uintmax_t file_size,
                  const Refuse& refuse) {
  MapImage image;
  image.width = header_number(in);
  image.height = header_number(in);
  image.white = header_number(in);
  if (image.width < 1 || image.height < 1 || image.width > kLargestSide ||
      image.height > kLargestSide || image.white < 1 || image.white > 255) {
    throw refuse("has a damaged header or more than 8 bits a pixel");
  }
  const auto size = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  // Before memory is taken: a damaged header may promise anything.
  if (file_size < size) throw refuse("is cut: it has fewer pixels than it says");
  image.pixels.resize(size);
  if (is_binary) {
    in.read(reinterpret_cast<char*>(image.pixels.data()), static_cast<std::streamsize>(size));
    if (static_cast<std::size_t>(in.gcount()) != size) {
      throw refuse("is cut: it has fewer pixels than it says");
    }
    return image;
  }
  for (std::uint8_t& pixel : image.pixels) {
    const int value = header_number(in);
    if (value < 0 || value > image.white) throw refuse("has a damaged pixel");
    pixel = static_cast<std::uint8_t>(value);
  }
  return image;
}

/// Frees what libpng keeps of an image, whatever is thrown.
struct PngImage {
  PngImage() {
    std::memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
  }
  ~PngImage() { png_image_free(&image); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
  png_image image;
};

MapImage read_png(const std::string& bytes, const Refuse& refuse) {
  PngImage png;
  if (png_image_begin_read_from_memory(&png.image, bytes.data(), bytes.size()) == 0) {
    throw refuse(std::string("is a damaged PNG: ") + png.image.message);
  }
  const auto size = static_cast<std::size_t>(png.image.width) * png.image.height;
  if (png.image.width > kLargestSide || png.image.height > kLargestSide || size > kMaxPngPixels) {
    throw refuse("has too many pixels");
  }
  const bool has_alpha = (png.image.format & PNG_FORMAT_FLAG_ALPHA) != 0;
  png.image.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> channels(PNG_IMAGE_SIZE(png.image));
  if (png_image_finish_read(&png.image, nullptr, channels.data(), 0, nullptr) == 0) {
    throw refuse(std::string("is a damaged PNG: ") + png.image.message);
  }
  MapImage image;
  image.width = static_cast<int>(png.image.width);
  image.height = static_cast<int>(png.image.height);
  image.pixels.reserve(size);
  for (std::size_t i = 0; i < channels.size(); i += 4) {
    image.pixels.push_back(
        static_cast<std::uint8_t>((channels[i] + channels[i + 1] + channels[i + 2] + 1) / 3));
    if (has_alpha) image.alpha.push_back(channels[i + 3]);
  }
  return image;
}

std::string png_bytes(const MapImage& image, const std::string& place) {
  const bool has_alpha = !image.alpha.empty();
  std::vector<std::uint8_t> channels;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    channels.push_back(image.pixels[i]);
    if (has_alpha) channels.push_back(image.alpha[i]);
  }
  PngImage png;
  png.image.width = static_cast<png_uint_32>(image.width);
  png.image.height = static_cast<png_uint_32>(image.height);
  png.image.format = has_alpha ? PNG_FORMAT_GA : PNG_FORMAT_GRAY;
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(png.image), '\0');
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&png.image, bytes.data(), &size, 0, channels.data(), 0, nullptr) ==
      0) {
    throw OutputError(place, std::string("cannot be written: ") + png.image.message, "ask for pgm");
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace

MapImage read_map_image(const fs::path& path, const std::string& yaml) {
  const Refuse refuse = [&](const std::string& why) {
    return InputError(path.string(), why,
                      "the image named in " + yaml + " must be a PGM, PNG or BMP");
  };
  std::ifstream in(path, std::ios::binary);
  if (!in || fs::is_directory(path)) throw refuse("the map's image is missing");
  char magic[2] = {};
  in.read(magic, 2);
  if (magic[0] == 'P' && (magic[1] == '5' || magic[1] == '2')) {
    return read_pgm(in, magic[1] == '5', fs::file_size(path), refuse);
  }
  in.seekg(0);
  if (magic[0] == 'B' && magic[1] == 'M') return read_bmp(in, fs::file_size(path), refuse);
  if (magic[0] != '\x89' || magic[1] != 'P') throw refuse("is no PGM, PNG or BMP image");
  return read_png({std::istreambuf_iterator<char>(in), {}}, refuse);
}

void write_map_image(const fs::path& path, const MapImage& image, MapImageFormat format) {
  WholeFile file(path);
  if (format == MapImageFormat::kPng) {
    file.stream() << png_bytes(image, path.string());
  } else {
    file.stream() << "P5\n" << image.width << ' ' << image.height << "\n255\n";
    file.stream().write(reinterpret_cast<const char*>(image.pixels.data()),
                        static_cast<std::streamsize>(image.pixels.size()));
  }
  file.commit();
}

}  // namespace strata::log
