// SPDX-License-Identifier: Apache-2.0
#include "tools/site/plan_picture.hpp"

#include <vector>

#include "tools/report/map_picture.hpp"

namespace strata::site {
namespace {

constexpr int kPixels = 1400;
constexpr report::Color kDrawn{220, 30, 30};

}  // namespace

report::Image draw_plan(const ReflectionGrid& drawing, const plan::SiteFromPlan& site_from_plan,
                        const ReflectionGrid& map) {
  std::vector<Eigen::Vector2d> points;
  CellRect rect = map.size() == 0 ? CellRect{} : report::known_rect(map);
  for (std::size_t i = 0; i < drawing.size(); ++i) {
    if (!is_occupied(drawing.values()[i])) continue;
    points.push_back(site_from_plan * drawing.center(drawing.cell(i)));
    const Cell cell = map.cell_at(points.back());
    rect = rect.united({cell, {cell.x + 1, cell.y + 1}});
  }
  report::MapPicture picture = report::draw_map(map, rect.inflated(10), kPixels);
  for (const Eigen::Vector2d& point : points) {
    const Eigen::Vector2i pixel = picture.pixel(point);
    picture.image.set(pixel.x(), pixel.y(), kDrawn);
  }
  return picture.image;
}

}  // namespace strata::site
