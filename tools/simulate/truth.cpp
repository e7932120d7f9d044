// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

namespace strata::simulate {
namespace {

using Eigen::Vector2d;
using report::Color;
using report::Image;

/// Rounds once, so that 1000 s reads as 1000.0.
double json_seconds(Stamp stamp) { return static_cast<double>(stamp.ns) / 1e9; }

/// From metres, y up, to pixels, y down.
struct Canvas {
  Image image;
  Vector2d upper_left_m;
  double pixels_per_m = 1.0;

  [[nodiscard]] Eigen::Vector2i pixel(const Vector2d& p) const {
    return {static_cast<int>(std::lround((p.x() - upper_left_m.x()) * pixels_per_m)),
            static_cast<int>(std::lround((upper_left_m.y() - p.y()) * pixels_per_m))};
  }
  void line(const Segment& s, Color color, bool thick) {
    const Eigen::Vector2i a = pixel(s.a);
    const Eigen::Vector2i b = pixel(s.b);
    image.line(a.x(), a.y(), b.x(), b.y(), color);
    if (!thick) return;
    const int steps = std::max(1, (b - a).cwiseAbs().maxCoeff());
    for (int i = 0; i <= steps; ++i) {
      image.dot(a.x() + (b.x() - a.x()) * i / steps, a.y() + (b.y() - a.y()) * i / steps, 1, color);
    }
  }
};

Canvas make_canvas(const Simulation& simulation, int max_pixels) {
  Vector2d low(1e9, 1e9);
  Vector2d high(-1e9, -1e9);
  const auto cover = [&](const Segment& s) {
    low = low.cwiseMin(s.a).cwiseMin(s.b);
    high = high.cwiseMax(s.a).cwiseMax(s.b);
  };
  for (const Segment& s : simulation.walls) cover(s);
  for (const ChangeableObject& object : simulation.objects) {
    for (const auto& shape : object.shapes) std::for_each(shape.begin(), shape.end(), cover);
  }
  for (const SimulatedDay& day : simulation.days) {
    for (const SimulatedScan& scan : day.scans) {
      cover({scan.map_from_robot.translation(), scan.map_from_robot.translation()});
    }
  }
  low -= Vector2d(0.3, 0.3);
  high += Vector2d(0.3, 0.3);
  const double scale = max_pixels / (high - low).maxCoeff();
  const Vector2d size = scale * (high - low);
  return {Image(static_cast<int>(size.x()) + 1, static_cast<int>(size.y()) + 1),
          {low.x(), high.y()},
          scale};
}

}  // namespace

Stamp stamp_at(const Simulation& simulation, int day, double at_s) {
  return simulation.days.at(static_cast<std::size_t>(day - 1)).begin + Duration::from_seconds(at_s);
}

std::vector<std::pair<Stamp, std::size_t>> timeline(const Simulation& simulation,
                                                    const ChangeableObject& object) {
  std::vector<std::pair<Stamp, std::size_t>> result;
  for (std::size_t d = 0; d < simulation.days.size(); ++d) {
    const int day = static_cast<int>(d) + 1;
    result.emplace_back(simulation.days[d].begin, object.state_at(day, 0.0));
    for (const StateChange& change : object.history) {
      if (change.day != day || change.at_s <= 0.0) continue;
      const Stamp stamp = stamp_at(simulation, day, change.at_s);
      if (stamp > simulation.days[d].end || change.state == result.back().second) continue;
      result.emplace_back(stamp, change.state);
    }
  }
  return result;
}

std::string states_json(const Simulation& simulation) {
  using Json = nlohmann::ordered_json;
  Json json{{"scenario", simulation.scenario.name}, {"seed", simulation.seed}};
  json["days"] = Json::array();
  for (std::size_t d = 0; d < simulation.days.size(); ++d) {
    const SimulatedDay& day = simulation.days[d];
    json["days"].push_back({{"day", d + 1},
                            {"begin_s", json_seconds(day.begin)},
                            {"end_s", json_seconds(day.end)},
                            {"scans", day.scans.size()}});
  }
  json["objects"] = Json::array();
  for (const ChangeableObject& object : simulation.objects) {
    const Eigen::Vector4d rect = object.bounds();
    Json states = Json::array();
    for (const auto& [stamp, state] : timeline(simulation, object)) {
      std::size_t day = 1;
      while (day < simulation.days.size() && simulation.days[day].begin <= stamp) ++day;
      states.push_back(
          {{"time_s", json_seconds(stamp)}, {"day", day}, {"state", object.states[state]}});
    }
    json["objects"].push_back({{"id", object.id},
                               {"kind", object.kind},
                               {"states", object.states},
                               {"rect", {rect[0], rect[1], rect[2], rect[3]}},
                               {"timeline", states}});
  }
  return json.dump(2) + "\n";
}

report::Image draw_world(const Simulation& simulation, int max_pixels) {
  // Told apart in common colour blindness too: blue, orange, green, purple, brown.
  constexpr std::array<Color, 5> kStates{
      {{0, 114, 178}, {230, 120, 0}, {0, 140, 100}, {160, 60, 150}, {120, 80, 40}}};
  Canvas canvas = make_canvas(simulation, max_pixels);
  for (const PersonConfig& person : simulation.scenario.people) {
    for (std::size_t i = 0; i + 3 < person.path.size(); i += 2) {
      const Vector2d a(person.path[i], person.path[i + 1]);
      const Vector2d b(person.path[i + 2], person.path[i + 3]);
      const double length = (b - a).norm();
      for (double at = 0.0; at < length; at += 0.2) {
        const Eigen::Vector2i p = canvas.pixel(a + at / length * (b - a));
        canvas.image.dot(p.x(), p.y(), 1, {150, 150, 150});
      }
    }
  }
  for (const SimulatedDay& day : simulation.days) {
    for (const SimulatedScan& scan : day.scans) {
      const Eigen::Vector2i p = canvas.pixel(scan.map_from_robot.translation());
      canvas.image.dot(p.x(), p.y(), 1, {140, 190, 230});
    }
  }
  for (const Segment& s : simulation.walls) canvas.line(s, {0, 0, 0}, true);
  for (const ChangeableObject& object : simulation.objects) {
    for (std::size_t state = 0; state < object.shapes.size(); ++state) {
      for (const Segment& s : object.shapes[state]) {
        canvas.line(s, kStates[state % kStates.size()], true);
      }
    }
  }
  return std::move(canvas.image);
}

}  // namespace strata::simulate
