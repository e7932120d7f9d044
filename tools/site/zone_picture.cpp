// SPDX-License-Identifier: Apache-2.0
#include "tools/site/zone_picture.hpp"

#include "tools/report/map_picture.hpp"

namespace strata::site {
namespace {

using report::Color;

constexpr int kMapPixels = 1400;

Color color_of(const Zone& zone) {
  switch (zone.kind) {
    case ZoneKind::kKeepout:
      return {200, 30, 30};
    case ZoneKind::kSpeed:
      return {240, 140, 0};
    case ZoneKind::kPreferred:
      return {0, 150, 80};
    case ZoneKind::kLift:
      return {0, 160, 170};
    case ZoneKind::kLearn:
      break;
  }
  if (zone.control == LearnControl::kNeverLearn) return {40, 90, 220};
  return zone.control == LearnControl::kStaticOnly ? Color{150, 60, 190} : Color{110, 110, 110};
}

void draw_ring(report::MapPicture& picture, const MetricRing& ring, Color color) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const auto from = picture.pixel(ring[i]);
    const auto to = picture.pixel(ring[(i + 1) % ring.size()]);
    picture.image.line(from.x(), from.y(), to.x(), to.y(), color);
  }
}

}  // namespace

report::Image draw_zones(const Zones& zones, const ReflectionGrid& map, const CellRect& rect) {
  report::MapPicture picture = report::draw_map(map, rect, kMapPixels);
  for (const Zone& zone : zones.zones) {
    for (const MetricPolygon& polygon : zone.shape) {
      draw_ring(picture, polygon.outer, color_of(zone));
      for (const MetricRing& hole : polygon.holes) draw_ring(picture, hole, color_of(zone));
    }
  }
  return picture.image;
}

}  // namespace strata::site
