// SPDX-License-Identifier: Apache-2.0
#include "tools/report/map_picture.hpp"

#include <algorithm>
#include <cmath>

#include "core/grid/counting_map.hpp"

namespace strata::report {
namespace {

constexpr int kGap = 12;
constexpr Color kPaper{255, 255, 255};
constexpr Color kUnknown{176, 182, 190};
constexpr Color kFrame{90, 90, 90};

Color shade(float reflection) {
  if (!is_known(reflection)) return kUnknown;
  const double light = 255.0 * (1.0 - static_cast<double>(std::clamp(reflection, 0.0F, 1.0F)));
  const auto level = static_cast<std::uint8_t>(std::lround(light));
  return {level, level, level};
}

}  // namespace

Eigen::Vector2i MapPicture::pixel(const Eigen::Vector2d& point_m) const {
  const double u = (point_m.x() / resolution_m - rect.min.x) * pixels_per_cell;
  const double v = (rect.max.y - point_m.y() / resolution_m) * pixels_per_cell;
  return {static_cast<int>(std::floor(u)), static_cast<int>(std::floor(v))};
}

CellRect known_rect(const ReflectionGrid& map, int margin) {
  CellRect known;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!is_known(map.values()[i])) continue;
    const Cell cell = map.cell(i);
    known = known.united({cell, {cell.x + 1, cell.y + 1}});
  }
  return known.empty() ? map.rect() : known.inflated(margin);
}

MapPicture draw_map(const ReflectionGrid& map, const CellRect& rect, int max_pixels) {
  const int longer = std::max({rect.width(), rect.height(), 1});
  const int scale = std::max(1, max_pixels / longer);
  MapPicture picture{Image(std::max(1, rect.width() * scale), std::max(1, rect.height() * scale)),
                     rect, map.resolution_m(), scale};
  for (int y = 0; y < picture.image.height(); ++y) {
    for (int x = 0; x < picture.image.width(); ++x) {
      const Cell cell{rect.min.x + x / scale, rect.max.y - 1 - y / scale};
      picture.image.set(x, y, map.contains(cell) ? shade(map.at(cell)) : kUnknown);
    }
  }
  return picture;
}

void mark_dynamic_beams(MapPicture& picture, std::span<const PosedScan> scans, Color color) {
  for (const PosedScan& scan : scans) {
    if (scan.static_probability.empty()) continue;
    for_each_ray(scan.scan, scan.map_from_laser(), {}, [&](std::size_t beam, const Ray& ray) {
      if (!ray.is_hit || !is_dynamic(scan.static_probability[beam])) return;
      const Eigen::Vector2i at = picture.pixel(ray.to_m);
      picture.image.dot(at.x(), at.y(), picture.pixels_per_cell > 2 ? 1 : 0, color);
    });
  }
}

void mark_trajectory(MapPicture& picture, std::span<const Pose2> poses, Color color) {
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Eigen::Vector2i a = picture.pixel(poses[i - 1].translation());
    const Eigen::Vector2i b = picture.pixel(poses[i].translation());
    picture.image.line(a.x(), a.y(), b.x(), b.y(), color);
  }
}

void mark_points(MapPicture& picture, std::span<const Eigen::Vector2d> points_m, Color color) {
  constexpr int kRadius = 3;
  for (const Eigen::Vector2d& point_m : points_m) {
    const Eigen::Vector2i at = picture.pixel(point_m);
    picture.image.dot(at.x(), at.y(), kRadius, color);
  }
}

void mark_submaps(MapPicture& picture, const patch::PatchMap& map, Color color) {
  for (const patch::Submap& submap : map.submaps) {
    const Eigen::Vector2i low = picture.pixel(
        {submap.rect.min.x * picture.resolution_m, submap.rect.max.y * picture.resolution_m});
    const int width = submap.rect.width() * picture.pixels_per_cell;
    const int height = submap.rect.height() * picture.pixels_per_cell;
    for (int inset = 0; inset < 2; ++inset) {
      picture.image.frame(low.x() + inset, low.y() + inset, low.x() + width - 1 - inset,
                          low.y() + height - 1 - inset, color);
    }
  }
}

Image draw_submap(const patch::Submap& submap, int pixels_per_cell) {
  const int width = submap.rect.width() * pixels_per_cell + 2;
  const int height = submap.rect.height() * pixels_per_cell + 2;
  const auto count = static_cast<int>(submap.configurations.size());
  Image row(std::max(1, count * (width + kGap) - kGap), height, kPaper);
  for (int c = 0; c < count; ++c) {
    const ReflectionGrid& reflection =
        submap.configurations[static_cast<std::size_t>(c)].reflection;
    const int longer = std::max(submap.rect.width(), submap.rect.height());
    const MapPicture picture = draw_map(reflection, submap.rect, longer * pixels_per_cell);
    const int left = c * (width + kGap);
    row.paste(picture.image, left + 1, 1);
    row.frame(left, 0, left + width - 1, height - 1, kFrame);
  }
  return row;
}

}  // namespace strata::report
