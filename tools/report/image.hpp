// SPDX-License-Identifier: Apache-2.0
/// An 8-bit RGB picture and its PNG form.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace strata::report {

struct Color {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  friend bool operator==(const Color&, const Color&) = default;
};

/// Rows from the top, x fastest.
class Image {
 public:
  Image(int width, int height, Color fill = {255, 255, 255});

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] Color at(int x, int y) const { return pixels_[index(x, y)]; }
  /// Ignored outside.
  void set(int x, int y, Color color);
  /// A filled square of 2 * radius + 1 pixels.
  void dot(int x, int y, int radius, Color color);
  /// A line of one pixel.
  void line(int x0, int y0, int x1, int y1, Color color);
  /// The outline of a rectangle, corners included.
  void frame(int x0, int y0, int x1, int y1, Color color);
  /// Copies another picture with its upper left corner at (x, y).
  void paste(const Image& other, int x, int y);
  [[nodiscard]] std::span<const Color> pixels() const { return pixels_; }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  int width_;
  int height_;
  std::vector<Color> pixels_;
};

/// The bytes of a PNG file. Throws OutputError.
[[nodiscard]] std::string encode_png(const Image& image);
/// Draws an SVG document at `scale` pixels a unit, into the bytes of a PNG. Throws OutputError with
/// what is wrong with the document.
[[nodiscard]] std::string render_svg_to_png(const std::string& svg, double scale);
/// Throws OutputError.
void write_file(const std::filesystem::path& path, const std::string& bytes);

}  // namespace strata::report
