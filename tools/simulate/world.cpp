// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "core/base/error.hpp"
#include "core/geometry/angle.hpp"
#include "core/random/stream.hpp"

namespace strata::simulate {
namespace {

using Eigen::Vector2d;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// A door this near to a wall's line is in that wall.
constexpr double kInWall_m = 0.02;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

std::vector<Segment> rectangle(const Vector2d& center, double length_m, double width_m,
                               double theta_rad) {
  const Vector2d u = 0.5 * length_m * Vector2d(std::cos(theta_rad), std::sin(theta_rad));
  const Vector2d v = 0.5 * width_m * Vector2d(-std::sin(theta_rad), std::cos(theta_rad));
  const Vector2d p[4] = {center - u - v, center + u - v, center + u + v, center - u + v};
  return {{p[0], p[1]}, {p[1], p[2]}, {p[2], p[3]}, {p[3], p[0]}};
}

/// The wall without the part that the closed door fills.
void cut_gap(std::vector<Segment>& walls, const Segment& door) {
  std::vector<Segment> result;
  for (const Segment& wall : walls) {
    const Vector2d along = wall.b - wall.a;
    const double length = along.norm();
    const Vector2d unit = along / std::max(length, 1e-12);
    const auto offset = [&](const Vector2d& p) { return std::abs(cross(unit, p - wall.a)); };
    double begin = unit.dot(door.a - wall.a);
    double end = unit.dot(door.b - wall.a);
    if (begin > end) std::swap(begin, end);
    if (length < 1e-9 || offset(door.a) > kInWall_m || offset(door.b) > kInWall_m || end <= 0.0 ||
        begin >= length) {
      result.push_back(wall);
      continue;
    }
    if (begin > 0.0) result.push_back({wall.a, wall.a + begin * unit, wall.glass_rad});
    if (end < length) result.push_back({wall.a + end * unit, wall.b, wall.glass_rad});
  }
  walls = std::move(result);
}

std::size_t draw_state(const StateConfig& config, std::size_t states, RandomStream& random) {
  if (config.probabilities.empty()) return random.below(static_cast<std::uint32_t>(states));
  return random.categorical(config.probabilities);
}

/// One fixed name order per object; throws for a name that is not in it.
std::size_t state_named(const ChangeableObject& object, const std::string& name) {
  const auto found = std::find(object.states.begin(), object.states.end(), name);
  if (found != object.states.end()) return static_cast<std::size_t>(found - object.states.begin());
  std::string known;
  for (const std::string& state : object.states) known += (known.empty() ? "" : ", ") + state;
  throw ConfigError(object.id + ".states.schedule", "has the unknown state '" + name + "'",
                    "choose one of " + known + ", random");
}

void check_probabilities(const ChangeableObject& object, const StateConfig& config) {
  if (config.probabilities.empty()) return;
  double sum = 0.0;
  for (const double p : config.probabilities) sum += p;
  if (config.probabilities.size() != object.states.size() || sum <= 0.0) {
    throw ConfigError(object.id + ".states.probabilities",
                      "are not one number for each of its " + std::to_string(object.states.size()) +
                          " states with a positive sum",
                      "give one for each, in the order places, absent or closed, ajar, open");
  }
}

std::vector<StateChange> make_history(const ChangeableObject& object, const StateConfig& config,
                                      int days, double day_length_s, std::uint64_t seed,
                                      std::uint32_t index) {
  check_probabilities(object, config);
  std::vector<StateChange> history;
  const auto stream = [&](std::uint64_t step) {
    return RandomStream(seed, StreamId::kSimulatorWorld, step, index);
  };
  if (!config.schedule.empty()) {
    std::uint64_t step = 0;
    for (const ScheduleEntry& entry : config.schedule) {
      const int first = entry.day == 0 ? 1 : entry.day;
      const int last = entry.day == 0 ? days : entry.day;
      for (int day = first; day <= last; ++day) {
        RandomStream random = stream(step++);
        const std::size_t state = entry.state == "random"
                                      ? draw_state(config, object.states.size(), random)
                                      : state_named(object, entry.state);
        history.push_back({day, entry.at_s, state});
      }
    }
    std::stable_sort(history.begin(), history.end(), [](const auto& a, const auto& b) {
      return std::pair(a.day, a.at_s) < std::pair(b.day, b.at_s);
    });
    if (history.front().day > 1 || history.front().at_s > 0.0) {
      history.insert(history.begin(), {1, 0.0, history.front().state});
    }
    return history;
  }
  for (int day = 1; day <= days; ++day) {
    // Objects that stay for days do not all move on the same one.
    const int phase = static_cast<int>(index) % config.redraw_every_days;
    if (day > 1 && (day - 1 - phase) % config.redraw_every_days != 0) continue;
    RandomStream random = stream(static_cast<std::uint64_t>(day));
    double at_s = 0.0;
    do {
      history.push_back({day, at_s, draw_state(config, object.states.size(), random)});
      at_s += config.redraw_every_s;
    } while (config.redraw_every_s > 0.0 && at_s < day_length_s);
  }
  return history;
}

ChangeableObject make_door(const DoorConfig& config) {
  const Segment closed{{config.at[0], config.at[1]}, {config.at[2], config.at[3]}};
  const Vector2d leaf = closed.b - closed.a;
  const auto opened = [&](double share) -> std::vector<Segment> {
    if (config.kind == DoorKind::kSliding) {
      if (share >= 1.0) return {};
      return {{closed.a, closed.a + (1.0 - share) * leaf}};
    }
    const double turn = degrees_to_radians(share * config.open_deg);
    const Vector2d turned(std::cos(turn) * leaf.x() - std::sin(turn) * leaf.y(),
                          std::sin(turn) * leaf.x() + std::cos(turn) * leaf.y());
    return {{closed.a, closed.a + turned}};
  };
  return {config.id,
          config.kind == DoorKind::kSliding ? "sliding door" : "hinged door",
          {"closed", "ajar", "open"},
          {{closed}, opened(config.ajar_share), opened(1.0)},
          {}};
}

ChangeableObject make_box(const BoxConfig& config) {
  ChangeableObject box{config.id, "box", {}, {}, {}};
  for (const PlaceConfig& place : config.places) {
    box.states.push_back(place.name);
    box.shapes.push_back(rectangle({place.x_m, place.y_m}, config.length_m, config.width_m,
                                   degrees_to_radians(place.theta_deg)));
  }
  box.states.emplace_back("absent");
  box.shapes.emplace_back();
  return box;
}

}  // namespace

double ray_to_segment(const Vector2d& from, const Vector2d& direction, const Segment& segment) {
  const Vector2d along = segment.b - segment.a;
  const Vector2d to_a = segment.a - from;
  const double denominator = cross(direction, along);
  if (std::abs(denominator) > 1e-12) {
    const double distance = cross(to_a, along) / denominator;
    const double share = cross(to_a, direction) / denominator;
    return distance >= 0.0 && share >= 0.0 && share <= 1.0 ? distance : kInfinity;
  }
  if (std::abs(cross(direction, to_a)) > 1e-12) return kInfinity;
  const double a = direction.dot(to_a);
  const double b = direction.dot(segment.b - from);
  if (a < 0.0 && b < 0.0) return kInfinity;
  return a >= 0.0 && b >= 0.0 ? std::min(a, b) : 0.0;
}

double ray_to_circle(const Vector2d& from, const Vector2d& direction, const Circle& circle) {
  const Vector2d to_center = circle.center - from;
  const double outside = to_center.squaredNorm() - circle.radius_m * circle.radius_m;
  if (outside <= 0.0) return 0.0;
  const double along = direction.dot(to_center);
  const double discriminant = along * along - outside;
  if (along < 0.0 || discriminant < 0.0) return kInfinity;
  return along - std::sqrt(discriminant);
}

bool returns_from(const Vector2d& direction, const Segment& segment) {
  if (segment.glass_rad <= 0.0) return true;
  // The sine of the angle to the normal is the cosine of that to the segment.
  const Vector2d along = (segment.b - segment.a).normalized();
  return std::abs(along.dot(direction)) <= std::sin(segment.glass_rad);
}

double distance_to_segment(const Vector2d& point, const Segment& segment) {
  const Vector2d along = segment.b - segment.a;
  const double share = along.dot(point - segment.a) / std::max(along.squaredNorm(), 1e-18);
  return (point - segment.a - std::clamp(share, 0.0, 1.0) * along).norm();
}

std::size_t ChangeableObject::state_at(int day, double time_s) const {
  std::size_t state = history.front().state;
  for (const StateChange& change : history) {
    if (std::pair(change.day, change.at_s) > std::pair(day, time_s)) break;
    state = change.state;
  }
  return state;
}

Eigen::Vector4d ChangeableObject::bounds() const {
  Eigen::Vector4d bounds(kInfinity, kInfinity, -kInfinity, -kInfinity);
  for (const auto& shape : shapes) {
    for (const Segment& segment : shape) {
      for (const Vector2d& p : {segment.a, segment.b}) {
        bounds.head<2>() = bounds.head<2>().cwiseMin(p);
        bounds.tail<2>() = bounds.tail<2>().cwiseMax(p);
      }
    }
  }
  return bounds;
}

World::World(const ScenarioConfig& scenario, std::uint64_t seed, double day_length_s) {
  for (const WallConfig& wall : scenario.walls) {
    for (std::size_t i = 0; i + 3 < wall.points.size(); i += 2) {
      walls_.push_back({{wall.points[i], wall.points[i + 1]},
                        {wall.points[i + 2], wall.points[i + 3]},
                        degrees_to_radians(wall.glass_deg)});
    }
  }
  for (const DoorConfig& door : scenario.doors) {
    objects_.push_back(make_door(door));
    cut_gap(walls_, objects_.back().shapes.front().front());
  }
  // After the doors: they cut walls, not furniture.
  first_block_side_ = walls_.size();
  for (const BlockConfig& block : scenario.blocks) {
    const Vector2d a(block.rect[0], block.rect[1]);
    const Vector2d b(block.rect[2], block.rect[3]);
    for (const Segment& side :
         rectangle(0.5 * (a + b), std::abs(b.x() - a.x()), std::abs(b.y() - a.y()), 0.0)) {
      walls_.push_back(side);
    }
  }
  for (const BoxConfig& box : scenario.boxes) objects_.push_back(make_box(box));

  std::set<std::string> ids;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (!ids.insert(objects_[i].id).second) {
      throw ConfigError(objects_[i].id, "is the id of two objects", "rename one of them");
    }
    const StateConfig& states = i < scenario.doors.size()
                                    ? scenario.doors[i].states
                                    : scenario.boxes[i - scenario.doors.size()].states;
    objects_[i].history = make_history(objects_[i], states, scenario.days, day_length_s, seed,
                                       static_cast<std::uint32_t>(i));
  }
}

}  // namespace strata::simulate
