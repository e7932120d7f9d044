// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/random_office.hpp"

#include <cmath>
#include <string>

#include "core/random/stream.hpp"

namespace strata::simulate {
namespace {

constexpr double kSouth = 4.5;  // the corridor's walls
constexpr double kNorth = 6.7;
constexpr double kDepth = 11.2;
constexpr double kMiddle = 5.6;
constexpr double kDoorWidth = 0.9;

/// Draws rooms along one side of the corridor.
class OfficeBuilder {
 public:
  OfficeBuilder(std::uint64_t seed, const RandomOfficeOptions& options)
      : random_(seed, StreamId::kSimulatorWorld, 4242), options_(options) {
    length_m_ = random_.uniform(16.0, 26.0);
    office_.name = "random_office";
    office_.days = options.days;
    wall({0.0, 0.0, length_m_, 0.0, length_m_, kDepth, 0.0, kDepth, 0.0, 0.0});
  }

  ScenarioConfig build() && {
    rooms(true);
    rooms(false);
    boxes();
    people();
    office_.robot.route = {1.0, kMiddle};
    for (const double door : open_south_) visit(door, kSouth - 1.6);
    for (const double door : open_north_) visit(door, kNorth + 1.6);
    add_point(length_m_ - 1.2, kMiddle);
    add_point(1.0, kMiddle);
    office_.robot.speed_mps = 0.75;
    office_.laser.range_max_m = 12.0;
    return std::move(office_);
  }

 private:
  void wall(std::vector<double> points) { office_.walls.push_back({std::move(points)}); }
  void add_point(double x_m, double y_m) {
    office_.robot.route.push_back(x_m);
    office_.robot.route.push_back(y_m);
  }
  void visit(double x_m, double y_m) {
    add_point(x_m, kMiddle);
    add_point(x_m, y_m);
    add_point(x_m, kMiddle);
  }
  [[nodiscard]] std::vector<double> probabilities() {
    if (options_.has_change) return {0.5, 0.0, 0.5};
    return random_.bernoulli(0.5) ? std::vector<double>{1.0, 0.0, 0.0}
                                  : std::vector<double>{0.0, 0.0, 1.0};
  }
  void rooms(bool is_south) {
    const double y = is_south ? kSouth : kNorth;
    double x0 = 0.0;
    while (x0 < length_m_ - 0.1) {
      double x1 = x0 + random_.uniform(3.0, 5.5);
      if (length_m_ - x1 < 3.0) x1 = length_m_;
      room(x0, x1, y, is_south);
      x0 = x1;
    }
  }
  void room(double x0, double x1, double y, bool is_south) {
    if (x1 < length_m_) wall({x1, is_south ? 0.0 : kNorth, x1, is_south ? kSouth : kDepth});
    const double d0 = random_.uniform(x0 + 0.5, x1 - 0.5 - kDoorWidth);
    const double d1 = d0 + kDoorWidth;
    auto& open = is_south ? open_south_ : open_north_;
    if (open.empty() && random_.bernoulli(0.4)) {
      // A wide doorway that is always open; the robot looks in.
      wall({x0, y, d0, y});
      wall({d1 + 0.2, y, x1, y});
      open.push_back(0.5 * (d0 + d1 + 0.2));
    } else {
      wall({x0, y, x1, y});
      DoorConfig door;
      door.id = "door_" + std::to_string(office_.doors.size());
      door.at = {d0, y, d1, y};
      door.open_deg = is_south ? -90.0 : 90.0;
      door.states.probabilities = probabilities();
      office_.doors.push_back(door);
    }
    // Furniture at the far wall.
    const double depth = random_.uniform(0.4, 1.2);
    const double b0 = random_.uniform(x0 + 0.2, x1 - 1.4);
    const double b1 = b0 + random_.uniform(0.5, 1.2);
    const double far = is_south ? 0.0 : kDepth;
    const double edge = is_south ? depth : kDepth - depth;
    office_.blocks.push_back({{b0, std::min(far, edge), b1, std::max(far, edge)}});
  }
  void boxes() {
    const int count = 1 + static_cast<int>(random_.below(3));
    for (int i = 0; i < count; ++i) {
      BoxConfig box;
      box.id = "box_" + std::to_string(i);
      box.length_m = random_.uniform(0.4, 0.7);
      box.width_m = 0.4;
      const double span = (length_m_ - 4.0) / count;
      const double x = 2.0 + span * i;
      box.places = {{"west", x + 0.2 * span, kSouth + 0.25, 0.0},
                    {"east", x + 0.7 * span, kSouth + 0.25, 0.0}};
      box.states.probabilities = options_.has_change ? std::vector<double>{0.5, 0.5, 0.0}
                                                     : std::vector<double>{1.0, 0.0, 0.0};
      office_.boxes.push_back(box);
    }
  }
  void people() {
    for (int i = 0; i < options_.people; ++i) {
      PersonConfig person;
      const double y = random_.uniform(kMiddle - 0.1, kNorth - 0.4);
      person.path = {random_.uniform(0.8, 4.0), y, random_.uniform(10.0, length_m_ - 0.8), y};
      person.speed_mps = random_.uniform(0.7, 1.2);
      office_.people.push_back(person);
    }
  }

  RandomStream random_;
  RandomOfficeOptions options_;
  ScenarioConfig office_;
  double length_m_ = 0.0;
  std::vector<double> open_south_;
  std::vector<double> open_north_;
};

}  // namespace

ScenarioConfig random_office(std::uint64_t seed, const RandomOfficeOptions& options) {
  return OfficeBuilder(seed, options).build();
}

}  // namespace strata::simulate
