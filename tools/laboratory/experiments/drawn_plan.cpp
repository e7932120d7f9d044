// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/drawn_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/random/stream.hpp"

namespace strata::experiments {
namespace {

using simulate::Segment;
using Point = Eigen::Vector2d;

/// A line of a drawing, in metres of the building.
struct Stroke {
  Segment line;
  double thick_m = 0.0;
  bool is_hollow = false;  ///< only its outline
};

class Draftsman {
 public:
  Draftsman(const simulate::Simulation& building, std::uint64_t seed)
      : building_(building), random_(seed, StreamId::kSimulatorWorld, 31'031) {}

  DrawnPlan draw() {
    pixel_m_ = random_.uniform(0.01, 0.04);
    const std::uint32_t style = random_.below(3);  // a line, a bar, two lines
    thick_m_ = style == 0 ? 0.0 : random_.uniform(0.08, 0.25);
    is_hollow_ = style == 2;
    const std::size_t walls = building_.walls.size() - 4 * building_.scenario.blocks.size();
    for (std::size_t i = 0; i < walls; ++i) {
      const Segment& wall = building_.walls[i];
      box_.extend(wall.a);
      box_.extend(wall.b);
    }
    const bool is_cut = is_cut_ = random_.bernoulli(0.25);
    const double end_x = box_.min().x() + random_.uniform(0.75, 0.9) * box_.sizes().x();
    for (std::size_t i = 0; i < walls; ++i) {
      const bool is_outer = i < 4;
      if (!is_outer && random_.bernoulli(0.1)) continue;
      Segment wall = building_.walls[i];
      if (is_cut && wall.a.x() > end_x && wall.b.x() > end_x) continue;
      if (is_cut) {
        wall.a.x() = std::min(wall.a.x(), end_x);
        wall.b.x() = std::min(wall.b.x(), end_x);
      }
      this->wall(wall);
    }
    for (const simulate::ChangeableObject& object : building_.objects) door(object);
    if (!is_cut && random_.bernoulli(0.4)) wing();
    words();
    if (random_.bernoulli(0.7)) frame();
    return drawn();
  }

 private:
  void wall(const Segment& wall) { strokes_.push_back({wall, thick_m_, is_hollow_}); }
  void thin(const Point& a, const Point& b) { strokes_.push_back({{a, b}, 0.0, false}); }

  void door(const simulate::ChangeableObject& object) {
    if (object.kind == "box") return;
    const Segment& closed = object.shapes.front().front();
    switch (random_.below(3)) {
      case 0:
        return;  // a gap
      case 1:
        return thin(closed.a, closed.b);
      default:
        break;
    }
    const Point leaf = closed.b - closed.a;
    const double side = random_.bernoulli(0.5) ? 1.0 : -1.0;
    Point last = closed.b;
    for (int i = 1; i <= 8; ++i) {
      const Eigen::Rotation2Dd turn(side * 0.5 * std::numbers::pi * i / 8.0);
      const Point at = closed.a + turn * leaf;
      thin(last, at);
      last = at;
    }
    thin(closed.a, last);
  }

  /// Rooms that the robot never saw.
  void wing() {
    const double x = box_.max().x();
    const double width = random_.uniform(4.0, 9.0);
    const double low = box_.min().y() + random_.uniform(0.0, 0.3) * box_.sizes().y();
    const double high = box_.max().y();
    wall({{x, low}, {x + width, low}});
    wall({{x + width, low}, {x + width, high}});
    wall({{x + width, high}, {x, high}});
    const double middle = random_.uniform(low + 2.0, high - 2.0);
    wall({{x + 1.2, middle}, {x + width, middle}});
    box_.extend(Point(x + width, high));
  }

  /// Strokes like those of letters.
  void words() {
    for (int word = 0; word < 8; ++word) {
      const Point at(random_.uniform(box_.min().x() + 1.0, box_.max().x() - 2.0),
                     random_.uniform(box_.min().y() + 0.5, box_.max().y() - 0.5));
      for (int letter = 0; letter < 6; ++letter) {
        const Point from = at + Point(0.2 * letter, 0.0);
        thin(from, from + Point(random_.uniform(0.0, 0.15), 0.25));
        thin(from + Point(0.0, 0.12), from + Point(0.12, random_.uniform(0.0, 0.25)));
      }
    }
  }

  void frame() {
    const double gap = random_.uniform(0.8, 2.5);
    const Point low = box_.min() - Point(gap, gap);
    const Point high = box_.max() + Point(gap, gap);
    thin(low, {high.x(), low.y()});
    thin({high.x(), low.y()}, high);
    thin(high, {low.x(), high.y()});
    thin({low.x(), high.y()}, low);
    thin({low.x(), low.y() + 1.0}, {high.x(), low.y() + 1.0});  // for the title
  }

  [[nodiscard]] DrawnPlan drawn() {
    const double scale = 1.0 + random_.uniform(-0.005, 0.005);
    const Pose2 turn{0.0, 0.0, random_.uniform(-std::numbers::pi, std::numbers::pi)};
    Eigen::AlignedBox2d extent;
    for (Stroke& stroke : strokes_) {
      stroke.line = {turn * stroke.line.a / scale, turn * stroke.line.b / scale};
      extent.extend(stroke.line.a);
      extent.extend(stroke.line.b);
    }
    const Point margin(random_.uniform(0.3, 2.0), random_.uniform(0.3, 2.0));
    const Point shift = margin - extent.min();
    const Point size = extent.sizes() + 2.0 * margin;
    DrawnPlan plan;
    plan.thick_m = thick_m_;
    plan.is_cut = is_cut_;
    plan.drawing = ReflectionGrid(
        pixel_m_,
        {{0, 0},
         {cell_coordinate(size.x(), pixel_m_) + 1, cell_coordinate(size.y(), pixel_m_) + 1}},
        0.0F);
    for (const Stroke& stroke : strokes_) {
      draw({{stroke.line.a + shift, stroke.line.b + shift}, stroke.thick_m, stroke.is_hollow},
           plan.drawing);
    }
    // site = scale * turn^-1 * (plan - shift)
    const Pose2 back = inverse(turn);
    const Point at = -(back * Point(scale * shift));
    plan.site_from_plan = {{at.x(), at.y(), back.theta}, scale};
    return plan;
  }

  static void draw(const Stroke& stroke, ReflectionGrid& drawing) {
    const double pixel_m = drawing.resolution_m();
    const double half = std::max(0.5 * stroke.thick_m, 0.6 * pixel_m);
    const Point reach(half + pixel_m, half + pixel_m);
    const Cell low = drawing.cell_at(stroke.line.a.cwiseMin(stroke.line.b) - reach);
    const Cell high = drawing.cell_at(stroke.line.a.cwiseMax(stroke.line.b) + reach);
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) {
        if (!drawing.contains({x, y})) continue;
        const double off = distance_to_segment(drawing.center({x, y}), stroke.line);
        if (off > half || (stroke.is_hollow && off < half - 1.2 * pixel_m)) continue;
        drawing.at({x, y}) = 1.0F;
      }
    }
  }

  const simulate::Simulation& building_;
  RandomStream random_;
  double pixel_m_ = 0.02;
  double thick_m_ = 0.0;
  bool is_hollow_ = false;
  bool is_cut_ = false;
  Eigen::AlignedBox2d box_;
  std::vector<Stroke> strokes_;
};

}  // namespace

DrawnPlan draw_plan(const simulate::Simulation& building, std::uint64_t seed) {
  return Draftsman(building, seed).draw();
}

}  // namespace strata::experiments
