// SPDX-License-Identifier: Apache-2.0
#include "components/log/map_bmp.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <vector>

#include "components/log/byte_cursor.hpp"

namespace strata::log {
namespace {

using Refuse = std::function<InputError(const std::string&)>;
using BmpBytes = std::vector<std::uint8_t>;

constexpr std::int64_t kLargestSide = 50'000;
constexpr std::size_t kFileHeaderSize = 14;
constexpr std::uint32_t kPlainHeaderSize = 40;
constexpr std::uint32_t kHeaderSizeV4 = 108;
constexpr std::uint32_t kHeaderSizeV5 = 124;
constexpr std::uint32_t kUncompressed = 0;
constexpr std::uint32_t kBitFields = 3;
constexpr std::size_t kNoByte = 4;  // of a pixel of 32 bits

struct Header {
  std::uint32_t pixels_at = 0;  ///< bytes from the beginning of the file
  std::size_t width = 0;
  std::size_t height = 0;
  bool top_first = false;
  std::size_t bits = 0;  ///< a pixel
  /// Of a pixel of 24 or 32 bits, the bytes with red, green, blue and opacity.
  std::array<std::size_t, 4> channels = {2, 1, 0, kNoByte};
  std::size_t colours = 0;  ///< of the palette

  [[nodiscard]] std::size_t row_size() const { return (width * bits + 31) / 32 * 4; }
};

BmpBytes take(std::istream& in, std::size_t size, const Refuse& refuse) {
  BmpBytes bytes(size);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (static_cast<std::size_t>(in.gcount()) != size) {
    throw refuse("is cut: it has fewer pixels than it says");
  }
  return bytes;
}

/// Which byte of a pixel the mask stands for.
std::size_t byte_of_mask(std::uint32_t mask, const Refuse& refuse) {
  for (std::size_t byte = 0; byte < kNoByte; ++byte) {
    if (mask == 0xFFU << (8 * byte)) return byte;
  }
  throw refuse("has channels of other than 8 bits, which is not read here");
}

/// in: behind the header of 40 bytes, whose masks follow it; they are a part of a V4 header.
void read_masks(std::istream& in, Header& header, bool has_opacity, const Refuse& refuse) {
  const BmpBytes bytes = take(in, has_opacity ? 16 : 12, refuse);
  ByteCursor cursor(bytes);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    header.channels[channel] = byte_of_mask(cursor.number<std::uint32_t>(), refuse);
  }
  if (!has_opacity) return;
  const auto mask = cursor.number<std::uint32_t>();
  if (mask != 0) header.channels[3] = byte_of_mask(mask, refuse);
}

/// Leaves `in` where the palette begins.
Header read_header(std::istream& in, const Refuse& refuse) {
  const BmpBytes bytes = take(in, kFileHeaderSize + kPlainHeaderSize, refuse);
  ByteCursor cursor(bytes);
  (void)cursor.take(10);  // "BM", the file's size, two reserved
  Header header;
  header.pixels_at = cursor.number<std::uint32_t>();
  const auto size = cursor.number<std::uint32_t>();
  const auto width = static_cast<std::int32_t>(cursor.number<std::uint32_t>());
  const auto height = static_cast<std::int32_t>(cursor.number<std::uint32_t>());
  (void)cursor.number<std::uint16_t>();  // planes
  header.bits = cursor.number<std::uint16_t>();
  const auto compression = cursor.number<std::uint32_t>();
  (void)cursor.take(12);  // the pixels' size, their number a metre
  const auto colours = cursor.number<std::uint32_t>();
  if (size != kPlainHeaderSize && size != kHeaderSizeV4 && size != kHeaderSizeV5) {
    throw refuse("is a BMP of a kind that is not read here, or damaged");
  }
  const std::int64_t rows = std::abs(static_cast<std::int64_t>(height));
  if (width < 1 || rows < 1 || width > kLargestSide || rows > kLargestSide) {
    throw refuse("has a damaged header");
  }
  header.width = static_cast<std::size_t>(width);
  header.height = static_cast<std::size_t>(rows);
  header.top_first = height < 0;
  const bool is_plain =
      compression == kUncompressed && (header.bits == 1 || header.bits == 4 || header.bits == 8 ||
                                       header.bits == 24 || header.bits == 32);
  if (!is_plain && !(compression == kBitFields && header.bits == 32)) {
    throw refuse("is a compressed BMP, or has another number of bits a pixel than 1, 4, 8, 24, 32");
  }
  if (compression == kBitFields) read_masks(in, header, size != kPlainHeaderSize, refuse);
  if (header.bits <= 8) {
    const std::size_t most = std::size_t{1} << header.bits;
    if (colours > most) throw refuse("has a damaged header");
    header.colours = colours == 0 ? most : colours;
  }
  if (size != kPlainHeaderSize) in.seekg(static_cast<std::streamoff>(kFileHeaderSize + size));
  return header;
}

std::uint8_t grey_of(std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
  return static_cast<std::uint8_t>((red + green + blue + 1) / 3);
}

/// The grey of each colour.
BmpBytes read_palette(std::istream& in, const Header& header, const Refuse& refuse) {
  const BmpBytes bytes = take(in, 4 * header.colours, refuse);
  BmpBytes greys;
  for (std::size_t i = 0; i < bytes.size(); i += 4) {
    greys.push_back(grey_of(bytes[i + 2], bytes[i + 1], bytes[i]));
  }
  return greys;
}

void put_row_by_palette(const BmpBytes& row, const Header& header, const BmpBytes& greys,
                        std::uint8_t* pixels, const Refuse& refuse) {
  const std::size_t per_byte = 8 / header.bits;
  const std::uint8_t mask = static_cast<std::uint8_t>((1U << header.bits) - 1U);
  for (std::size_t x = 0; x < header.width; ++x) {
    const std::size_t shift = header.bits * (per_byte - 1 - x % per_byte);  // leftmost: highest
    const auto colour = static_cast<std::size_t>((row[x / per_byte] >> shift) & mask);
    if (colour >= greys.size()) throw refuse("has a pixel of a colour that its palette lacks");
    pixels[x] = greys[colour];
  }
}

void put_row(const BmpBytes& row, const Header& header, std::uint8_t* pixels, std::uint8_t* alpha) {
  const std::size_t step = header.bits / 8;
  const auto& [red, green, blue, opacity] = header.channels;
  for (std::size_t x = 0; x < header.width; ++x) {
    const std::uint8_t* pixel = row.data() + x * step;
    pixels[x] = grey_of(pixel[red], pixel[green], pixel[blue]);
    if (alpha != nullptr) alpha[x] = pixel[opacity];
  }
}

}  // namespace

MapImage read_bmp(std::istream& in, std::uintmax_t file_size, const Refuse& refuse) {
  const Header header = read_header(in, refuse);
  // Before memory is taken: a damaged header may promise anything.
  if (file_size < header.pixels_at + std::uintmax_t{header.row_size()} * header.height) {
    throw refuse("is cut: it has fewer pixels than it says");
  }
  const BmpBytes greys = header.bits <= 8 ? read_palette(in, header, refuse) : BmpBytes();
  MapImage image;
  image.width = static_cast<int>(header.width);
  image.height = static_cast<int>(header.height);
  image.pixels.resize(header.width * header.height);
  if (header.channels[3] != kNoByte) image.alpha.resize(image.pixels.size());
  in.seekg(static_cast<std::streamoff>(header.pixels_at));
  for (std::size_t i = 0; i < header.height; ++i) {
    const BmpBytes row = take(in, header.row_size(), refuse);
    const std::size_t at = header.width * (header.top_first ? i : header.height - 1 - i);
    if (header.bits <= 8) {
      put_row_by_palette(row, header, greys, image.pixels.data() + at, refuse);
    } else {
      put_row(row, header, image.pixels.data() + at,
              image.alpha.empty() ? nullptr : image.alpha.data() + at);
    }
  }
  return image;
}

}  // namespace strata::log
