// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/random_floor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/random/stream.hpp"
#include "tools/simulate/world.hpp"

namespace strata::simulate {
namespace {

using Point = Eigen::Vector2d;

constexpr double kMinSide_m = 2.8;      // of a room
constexpr double kDoor_m = 0.9;         // wide
constexpr double kCutFromGap_m = 1.1;   // a cut ends no nearer to the middle of a gap
constexpr double kClearOfWay_m = 0.75;  // what stands about, of the robot's way
constexpr double kClearOfDoor_m = 1.1;  // ... and of a door's middle
constexpr double kFromPassage_m = 0.7;  // the way is straight so far on both sides of a passage

struct Room {
  Point low;
  Point high;
  [[nodiscard]] Point middle() const { return 0.5 * (low + high); }
  [[nodiscard]] bool contains(const Point& p) const {
    return (p.array() > low.array()).all() && (p.array() < high.array()).all();
  }
};

/// A gap in a wall: where its middle is, and along which axis the wall runs.
struct Gap {
  Point middle;
  int axis = 0;
  bool is_passage = false;  ///< always open; else a door
  [[nodiscard]] Point beside(double distance_m) const {
    Point p = middle;
    p(1 - axis) += distance_m;
    return p;
  }
};

class FloorBuilder {
 public:
  FloorBuilder(std::uint64_t seed, const RandomFloorOptions& options)
      : random_(seed, StreamId::kSimulatorWorld, 77'001), options_(options) {}

  ScenarioConfig build() && {
    const Point size(random_.uniform(16.0, 26.0), random_.uniform(11.0, 17.0));
    wall({0.0, 0.0, size.x(), 0.0, size.x(), size.y(), 0.0, size.y(), 0.0, 0.0});
    cut({Point::Zero(), size});
    visit(0, std::nullopt);
    for (const Room& room : rooms_) furnish(room);
    for (int i = 0; i < options_.people; ++i) add_person();
    floor_.name = "random_floor";
    floor_.days = options_.days;
    floor_.robot.speed_mps = 0.8;
    floor_.robot.trans_noise = 0.03;
    floor_.robot.scale_stddev = 0.03;
    floor_.laser.beams = 270;
    floor_.laser.field_of_view_deg = 270.0;
    floor_.laser.range_max_m = options_.reach_m;
    floor_.laser.noise_m = 0.015;
    floor_.laser.outlier_probability = 0.002;
    return std::move(floor_);
  }

 private:
  void wall(std::vector<double> points) { floor_.walls.push_back({std::move(points)}); }

  /// Cuts across the longer side, or keeps the room as it is.
  void cut(const Room& room) {
    const Point size = room.high - room.low;
    const int along = size.x() > size.y() ? 0 : 1;  // the axis that is divided
    const bool is_small = size.x() * size.y() < 30.0 && random_.bernoulli(0.7);
    const double free_m = size(along) - 2.0 * kMinSide_m;
    for (int tried = 0; !is_small && free_m > 0.2 && tried < 30; ++tried) {
      const double at = room.low(along) + kMinSide_m + random_.uniform(0.0, free_m);
      if (!is_clear_of_gaps(room, along, at)) continue;
      divide(room, along, at);
      return;
    }
    rooms_.push_back(room);
  }

  /// Whether no gap of the room's own walls is where the new wall would meet them.
  [[nodiscard]] bool is_clear_of_gaps(const Room& room, int along, double at) const {
    return std::none_of(gaps_.begin(), gaps_.end(), [&](const Gap& gap) {
      const double across = gap.middle(1 - along);
      const bool is_on_room = gap.axis == along && across > room.low(1 - along) - 0.01 &&
                              across < room.high(1 - along) + 0.01 &&
                              gap.middle(along) > room.low(along) &&
                              gap.middle(along) < room.high(along);
      return is_on_room && std::abs(gap.middle(along) - at) < kCutFromGap_m;
    });
  }

  void divide(const Room& room, int along, double at) {
    const int axis = 1 - along;  // of the new wall
    const double from = room.low(axis);
    const double to = room.high(axis);
    const auto point = [&](double on_wall) {
      Point p;
      p(along) = at;
      p(axis) = on_wall;
      return p;
    };
    const double width = random_.uniform(1.0, 1.6);
    const double passage = random_.uniform(from + 0.3 + width, to - 0.3 - width);
    gaps_.push_back({point(passage), axis, true});
    piece(point(from), point(passage - 0.5 * width));
    piece(point(passage + 0.5 * width), point(to));
    add_door(point, from, to, passage, width);
    Room first = room;
    Room second = room;
    first.high(along) = second.low(along) = at;
    cut(first);
    cut(second);
  }

  void piece(const Point& a, const Point& b) { wall({a.x(), a.y(), b.x(), b.y()}); }

  template <typename PointOnWall>
  void add_door(const PointOnWall& point, double from, double to, double passage, double width) {
    for (int tried = 0; tried < 10; ++tried) {
      if (!random_.bernoulli(0.75) || to - from < 4.0) return;
      const double middle = random_.uniform(from + 0.8, to - 0.8);
      if (std::abs(middle - passage) < 0.5 * (width + kDoor_m) + 0.5) continue;
      DoorConfig door;
      door.id = "door_" + std::to_string(floor_.doors.size());
      door.kind = random_.bernoulli(0.5) ? DoorKind::kSliding : DoorKind::kHinged;
      const Point hinge = point(middle - 0.5 * kDoor_m);
      const Point latch = point(middle + 0.5 * kDoor_m);
      door.at = {hinge.x(), hinge.y(), latch.x(), latch.y()};
      door.open_deg = random_.bernoulli(0.5) ? 85.0 : -85.0;
      const double closed = random_.uniform(0.3, 0.7);
      door.states.probabilities = {closed, 0.0, 1.0 - closed};
      if (random_.bernoulli(1.0 / 3.0)) door.states.redraw_every_s = 60.0;
      floor_.doors.push_back(door);
      gaps_.push_back({point(middle), hinge.x() == latch.x() ? 1 : 0, false});
      return;
    }
  }

  [[nodiscard]] std::optional<std::size_t> room_at(const Point& p) const {
    for (std::size_t i = 0; i < rooms_.size(); ++i) {
      if (rooms_[i].contains(p)) return i;
    }
    return std::nullopt;
  }

  /// To the middle of a room, into each neighbour that was not visited yet, and back.
  void visit(std::size_t room, std::optional<std::size_t> from) {
    go(rooms_[room].middle());
    for (const Gap& gap : gaps_) {
      if (!gap.is_passage) continue;
      const auto low = room_at(gap.beside(-0.3));
      const auto high = room_at(gap.beside(0.3));
      if (!low || !high || (*low != room && *high != room)) continue;
      const std::size_t next = *low == room ? *high : *low;
      if (next == from) continue;  // the passages make a tree
      const double side_m = *low == room ? -kFromPassage_m : kFromPassage_m;
      legs_.push_back(
          {rooms_[room].middle(), gap.beside(side_m), gap.beside(-side_m), rooms_[next].middle()});
      go(gap.beside(side_m));
      go(gap.beside(-side_m));
      visit(next, room);
      go(gap.beside(-side_m));
      go(gap.beside(side_m));
      go(rooms_[room].middle());
    }
  }
  void go(const Point& p) {
    floor_.robot.route.push_back(p.x());
    floor_.robot.route.push_back(p.y());
  }

  /// Whether a disc there is out of everybody's way.
  [[nodiscard]] bool is_clear(const Point& p, double radius_m) const {
    for (const auto& leg : legs_) {
      for (std::size_t i = 1; i < leg.size(); ++i) {
        if (distance_to_segment(p, {leg[i - 1], leg[i]}) < radius_m + kClearOfWay_m) return false;
      }
    }
    return std::all_of(gaps_.begin(), gaps_.end(), [&](const Gap& gap) {
      return (gap.middle - p).norm() > radius_m + kClearOfDoor_m;
    });
  }

  /// A place for something of that half width at a wall; nothing where none was found.
  [[nodiscard]] std::optional<Point> place_at_wall(const Room& room, double half_m) {
    for (int tried = 0; tried < 20; ++tried) {
      Point p(random_.uniform(room.low.x() + half_m, room.high.x() - half_m),
              random_.uniform(room.low.y() + half_m, room.high.y() - half_m));
      const int side = static_cast<int>(random_.below(4));
      const double inset = half_m + 0.05;
      p(side % 2) = side < 2 ? room.low(side % 2) + inset : room.high(side % 2) - inset;
      if (is_clear(p, std::sqrt(2.0) * half_m)) return p;
    }
    return std::nullopt;
  }

  void furnish(const Room& room) {
    const int pieces = static_cast<int>(random_.below(4));
    for (int i = 0; i < pieces; ++i) {
      const double half = random_.uniform(0.2, 0.45);
      const auto p = place_at_wall(room, half);
      if (!p) continue;
      floor_.blocks.push_back({{p->x() - half, p->y() - half, p->x() + half, p->y() + half}});
    }
    if (random_.bernoulli(0.4)) add_box(room, false);
    if (options_.has_new_boxes && random_.bernoulli(0.5)) add_box(room, true);
  }

  void add_box(const Room& room, bool is_new) {
    BoxConfig box;
    box.id = (is_new ? "new_" : "box_") + std::to_string(floor_.boxes.size());
    box.length_m = box.width_m = random_.uniform(0.4, 0.7);
    for (const char* name : {"a", "b"}) {
      if (const auto p = place_at_wall(room, 0.5 * box.length_m)) {
        box.places.push_back({name, p->x(), p->y(), 0.0});
      }
    }
    if (box.places.empty()) return;
    if (is_new) {
      box.states.schedule = {{1, 0.0, "absent"}, {options_.days, 0.0, box.places.front().name}};
    }
    floor_.boxes.push_back(box);
  }

  void add_person() {
    if (legs_.empty()) return;
    PersonConfig person;
    const auto& leg = legs_[random_.below(static_cast<std::uint32_t>(legs_.size()))];
    for (const Point& p : leg) {
      person.path.push_back(p.x());
      person.path.push_back(p.y());
    }
    person.speed_mps = random_.uniform(0.7, 1.2);
    floor_.people.push_back(person);
  }

  RandomStream random_;
  RandomFloorOptions options_;
  ScenarioConfig floor_;
  std::vector<Room> rooms_;
  std::vector<Gap> gaps_;
  std::vector<std::array<Point, 4>> legs_;  // from the middle of a room to that of the next
};

}  // namespace

ScenarioConfig random_floor(std::uint64_t seed, const RandomFloorOptions& options) {
  return FloorBuilder(seed, options).build();
}

}  // namespace strata::simulate
