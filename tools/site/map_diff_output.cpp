// SPDX-License-Identifier: Apache-2.0
// A difference as GeoJSON and as a picture.
#include "tools/report/map_picture.hpp"
#include "tools/site/map_diff.hpp"

namespace strata::site {
namespace {

using nlohmann::json;
using report::Color;

constexpr int kDiffPixels = 1400;

Color color_of(ChangeKind kind) {
  switch (kind) {
    case ChangeKind::kCame:
      return {200, 30, 30};
    case ChangeKind::kWent:
      return {40, 90, 220};
    case ChangeKind::kMoved:
      return {240, 140, 0};
    case ChangeKind::kExplored:
      return {0, 150, 80};
    case ChangeKind::kForgotten:
      return {110, 110, 110};
    case ChangeKind::kPlaceCame:
    case ChangeKind::kPlaceWent:
      return {150, 60, 190};
  }
  return {};
}

/// Closed, as RFC 7946 has it.
json ring_json(const CellRing& ring, double resolution_m) {
  json points = json::array();
  for (std::size_t i = 0; i <= ring.size(); ++i) {
    const Cell& corner = ring[i % ring.size()];
    points.push_back({corner.x * resolution_m, corner.y * resolution_m});
  }
  return points;
}

json geometry_of(const MapChange& change, double resolution_m) {
  json polygons = json::array();
  for (const CellPolygon& polygon : change.shape) {
    json rings = json::array({ring_json(polygon.outer, resolution_m)});
    for (const CellRing& hole : polygon.holes) rings.push_back(ring_json(hole, resolution_m));
    polygons.push_back(rings);
  }
  return {{"type", "MultiPolygon"}, {"coordinates", polygons}};
}

void draw_ring(report::MapPicture& picture, const CellRing& ring, Color color) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Cell& a = ring[i];
    const Cell& b = ring[(i + 1) % ring.size()];
    const auto from = picture.pixel(Eigen::Vector2d(a.x, a.y) * picture.resolution_m);
    const auto to = picture.pixel(Eigen::Vector2d(b.x, b.y) * picture.resolution_m);
    picture.image.line(from.x(), from.y(), to.x(), to.y(), color);
  }
}

}  // namespace

json to_geojson(const MapDiff& diff, const std::string& frame) {
  json features = json::array();
  for (const MapChange& change : diff.changes) {
    json properties{{"kind", name_of(change.kind)},
                    {"area_m2", change.area_m2},
                    {"confidence", change.confidence},
                    {"center", {change.center_m.x(), change.center_m.y()}}};
    if (change.from_m) properties["from"] = {change.from_m->x(), change.from_m->y()};
    features.push_back({{"type", "Feature"},
                        {"geometry", geometry_of(change, diff.resolution_m)},
                        {"properties", properties}});
  }
  return {{"type", "FeatureCollection"},
          {"frame", frame},  // metres in it, no degrees
          {"unit", "m"},
          {"features", features}};
}

report::Image draw(const MapDiff& diff, const DiffSide& before, const DiffSide& after) {
  const CellRect rect = report::known_rect(after.map).united(report::known_rect(before.map));
  report::MapPicture picture = report::draw_map(after.map, rect, kDiffPixels);
  for (const MapChange& change : diff.changes) {
    const Color color = color_of(change.kind);
    for (const CellPolygon& polygon : change.shape) {
      draw_ring(picture, polygon.outer, color);
      for (const CellRing& hole : polygon.holes) draw_ring(picture, hole, color);
    }
    if (!change.from_m) continue;
    const auto from = picture.pixel(*change.from_m);
    const auto to = picture.pixel(change.center_m);
    picture.image.line(from.x(), from.y(), to.x(), to.y(), color);
  }
  return picture.image;
}

}  // namespace strata::site
