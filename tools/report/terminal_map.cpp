// SPDX-License-Identifier: Apache-2.0
#include "tools/report/terminal_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "tools/report/map_picture.hpp"
#include "tools/report/plot.hpp"

namespace strata::report {
namespace {

constexpr int kDotsAcross = 2;  // of a character
constexpr int kDotsDown = 4;
/// Bits of U+2800 to U+28FF, row by row (Unicode, "Braille Patterns").
constexpr std::array<std::uint8_t, 8> kBits{0x01, 0x08, 0x02, 0x10, 0x04, 0x20, 0x40, 0x80};
constexpr const char* kBullet = "\u2022";
/// Readable on black and on white.
constexpr const char* kWayColor = "\x1b[35m";
constexpr const char* kNoColor = "\x1b[0m";

/// A character: dots of what stands there, and of the way through it.
struct Character {
  std::uint8_t walls = 0;
  std::uint8_t way = 0;
};

/// Dots from the upper left.
class Canvas {
 public:
  Canvas(int dots_across, int dots_down)
      : columns_((dots_across + kDotsAcross - 1) / kDotsAcross),
        rows_((dots_down + kDotsDown - 1) / kDotsDown),
        characters_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

  void set(int x, int y, std::uint8_t Character::*layer) {
    const auto at = static_cast<std::size_t>(y / kDotsDown) * static_cast<std::size_t>(columns_) +
                    static_cast<std::size_t>(x / kDotsAcross);
    const int dot = y % kDotsDown * kDotsAcross + x % kDotsAcross;
    characters_[at].*layer |= kBits[static_cast<std::size_t>(dot)];
  }

  [[nodiscard]] std::string text(bool color) const;

 private:
  int columns_;
  int rows_;
  std::vector<Character> characters_;
};

std::string braille(std::uint8_t bits) {
  return {'\xe2', static_cast<char>(0xa0 | bits >> 6), static_cast<char>(0x80 | (bits & 0x3f))};
}

std::string Canvas::text(bool color) const {
  std::string text;
  for (int row = 0; row < rows_; ++row) {
    std::string line;
    std::size_t end = 0;  // of what is to be seen
    bool in_color = false;
    for (int column = 0; column < columns_; ++column) {
      const auto at = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                      static_cast<std::size_t>(column);
      const auto [walls, way] = characters_[at];
      if (color && (way != 0) != in_color) {
        in_color = !in_color;
        line += in_color ? kWayColor : kNoColor;
        end = line.size();
      }
      if (way == 0 && walls == 0) {
        line += ' ';
        continue;
      }
      // A character has one colour: walls beside the way would take it.
      line += way == 0 ? braille(walls) : color ? braille(way) : kBullet;
      end = line.size();
    }
    line.resize(end);
    text += line + (in_color ? kNoColor : "") + '\n';
  }
  return text;
}

/// What is drawn: cells, and how many of them are the side of a dot.
struct Frame {
  CellRect rect;
  int cells_a_dot = 1;
  double resolution_m = 0.05;

  [[nodiscard]] int across() const { return (rect.width() + cells_a_dot - 1) / cells_a_dot; }
  [[nodiscard]] int down() const { return (rect.height() + cells_a_dot - 1) / cells_a_dot; }
  [[nodiscard]] Eigen::Vector2i dot(const Cell& cell) const {
    return {(cell.x - rect.min.x) / cells_a_dot, (rect.max.y - 1 - cell.y) / cells_a_dot};
  }
  [[nodiscard]] Cell cell(const Pose2& pose) const {
    return cell_at(pose.translation(), resolution_m);
  }
};

/// shape: with room for a character.
Frame frame_of(const ReflectionGrid& map, std::span<const TerminalWay> ways,
               const TerminalShape& shape) {
  Frame frame{{}, 1, map.resolution_m()};
  // Where nothing is known known_rect would be all of the map.
  if (std::any_of(map.values().begin(), map.values().end(), is_known)) {
    frame.rect = known_rect(map, 0);
  }
  for (const TerminalWay& way : ways) {
    for (const Pose2& pose : way) {
      if (!is_finite(pose)) continue;
      const Cell cell = frame.cell(pose);
      frame.rect = frame.rect.united({cell, {cell.x + 1, cell.y + 1}});
    }
  }
  const int across = shape.columns * kDotsAcross;
  const int down = shape.rows * kDotsDown;
  frame.cells_a_dot = std::max(
      {1, (frame.rect.width() + across - 1) / across, (frame.rect.height() + down - 1) / down});
  return frame;
}

void draw_line(const Eigen::Vector2i& from, const Eigen::Vector2i& to, Canvas& canvas) {
  const Eigen::Vector2i way = to - from;
  const int steps = std::max({1, std::abs(way.x()), std::abs(way.y())});
  for (int i = 0; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    canvas.set(from.x() + static_cast<int>(std::lround(share * way.x())),
               from.y() + static_cast<int>(std::lround(share * way.y())), &Character::way);
  }
}

void draw_way(const TerminalWay& way, const Frame& frame, Canvas& canvas) {
  const Pose2* last = nullptr;
  for (const Pose2& pose : way) {
    if (!is_finite(pose)) continue;
    const Eigen::Vector2i here = frame.dot(frame.cell(pose));
    const bool drove = last != nullptr && translation_distance(*last, pose) <= kLeap_m;
    draw_line(drove ? frame.dot(frame.cell(*last)) : here, here, canvas);
    last = &pose;
  }
}

}  // namespace

std::string terminal_map(const ReflectionGrid& map, std::span<const TerminalWay> ways,
                         const TerminalShape& shape) {
  if (shape.columns < 1 || shape.rows < 1) return "";
  const Frame frame = frame_of(map, ways, shape);
  if (frame.rect.empty()) return "";
  Canvas canvas(frame.across(), frame.down());
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!is_occupied(map.values()[i])) continue;
    const Eigen::Vector2i dot = frame.dot(map.cell(i));
    canvas.set(dot.x(), dot.y(), &Character::walls);
  }
  for (const TerminalWay& way : ways) draw_way(way, frame, canvas);
  return canvas.text(shape.color) + fixed(frame.rect.width() * frame.resolution_m, 1) + " m x " +
         fixed(frame.rect.height() * frame.resolution_m, 1) + " m\n";
}

}  // namespace strata::report
