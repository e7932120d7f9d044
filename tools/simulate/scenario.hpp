// SPDX-License-Identifier: Apache-2.0
/// What a simulated world is made of, as a scenario file says it.
/// Lengths in metres in the map frame, times in seconds from the start of a day, days from 1.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "core/base/config.hpp"
#include "tools/simulate/space_config.hpp"

namespace strata::simulate {

enum class DoorKind {
  kHinged,   ///< open: the leaf is turned about its hinge
  kSliding,  ///< open: the leaf is gone into the wall
};

}  // namespace strata::simulate

template <>
struct strata::EnumNames<strata::simulate::DoorKind> {
  static constexpr std::array<std::pair<strata::simulate::DoorKind, const char*>, 2> values{
      {{strata::simulate::DoorKind::kHinged, "hinged"},
       {strata::simulate::DoorKind::kSliding, "sliding"}}};
};

namespace strata::simulate {

/// Thin walls along a chain of points. Doors in them cut their own gaps.
struct WallConfig {
  std::vector<double> points;
  double glass_deg = 0.0;  // 0: of no glass
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("points", c.points, {.doc = "x0, y0, x1, y1, ... of a chain of walls", .unit = "m"});
    v.require(c.points.size() >= 4 && c.points.size() % 2 == 0, "points",
              "are not two or more pairs of numbers", "write [x0, y0, x1, y1, ...]");
    v.field(
        "glass_deg", c.glass_deg,
        {.doc = "of glass: only beams so near to its normal return", .unit = "deg", .min = 0.0});
  }
};

/// A solid rectangle: furniture, a pillar, a room's outline.
struct BlockConfig {
  std::vector<double> rect;
  double height_m = 0.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("rect", c.rect, {.doc = "x0, y0, x1, y1: two opposite corners", .unit = "m"});
    v.field("height_m", c.height_m,
            {.doc = "for the 3-D scanner; 0: heights.block_m", .unit = "m", .min = 0.0});
    v.require(c.rect.size() == 4, "rect", "is not four numbers", "write [x0, y0, x1, y1]");
  }
};

/// From when on an object is in a state, over the following days too. Day 0: at each day's time.
struct ScheduleEntry {
  int day = 1;
  double at_s = 0.0;
  std::string state;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("day", c.day, {.doc = "which day, from 1; 0: every day", .min = 0});
    v.field("at_s", c.at_s, {.doc = "when on that day", .unit = "s", .min = 0.0});
    v.field("state", c.state, {.doc = "the state's name, or random: drawn by the probabilities"});
  }
};

/// How an object's state comes about: by schedule, else drawn.
struct StateConfig {
  std::vector<ScheduleEntry> schedule;
  std::vector<double> probabilities;
  double redraw_every_s = 0.0;
  int redraw_every_days = 1;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.list("schedule", c.schedule, "states at given times; without any, states are drawn");
    v.field("probabilities", c.probabilities,
            {.doc = "of the states, in their order; empty: all equal", .min = 0.0, .max = 1.0});
    v.field("redraw_every_s", c.redraw_every_s,
            {.doc = "a drawn state is drawn again this often; 0: at the start of a day only",
             .unit = "s",
             .min = 0.0});
    v.field("redraw_every_days", c.redraw_every_days,
            {.doc = "a drawn state is drawn again at the start of every so many days, on days that "
                    "the object has for itself",
             .unit = "days",
             .min = 1});
  }
};

/// States: closed, ajar, open.
struct DoorConfig {
  std::string id;
  DoorKind kind = DoorKind::kHinged;
  std::vector<double> at;
  double open_deg = 90.0;
  double ajar_share = 0.4;
  StateConfig states;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("id", c.id, {.doc = "name in states.json"});
    v.field("kind", c.kind, {.doc = "how it opens"});
    v.field("at", c.at, {.doc = "x0, y0, x1, y1: hinge and latch when closed", .unit = "m"});
    v.field("open_deg", c.open_deg,
            {.doc = "turn of a hinged leaf when open, counter-clockwise positive",
             .unit = "deg",
             .min = -180.0,
             .max = 180.0});
    v.field("ajar_share", c.ajar_share,
            {.doc = "how far open it is when ajar", .min = 0.0, .max = 1.0});
    v.group("states", c.states, "when it is closed, ajar, open");
    v.require(!c.id.empty(), "id", "is missing", "name every door");
    v.require(c.at.size() == 4, "at", "is not four numbers", "write [x0, y0, x1, y1]");
  }
};

/// One place of a box.
struct PlaceConfig {
  std::string name;
  double x_m = 0.0;
  double y_m = 0.0;
  double theta_deg = 0.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("name", c.name, {.doc = "the state's name"});
    v.field("x_m", c.x_m, {.doc = "centre", .unit = "m"});
    v.field("y_m", c.y_m, {.doc = "centre", .unit = "m"});
    v.field("theta_deg", c.theta_deg, {.doc = "heading", .unit = "deg"});
    v.require(!c.name.empty() && c.name != "absent" && c.name != "random", "name",
              "is missing or a word with a meaning of its own", "name every place");
  }
};

/// States: its places in order, then absent.
struct BoxConfig {
  std::string id;
  double length_m = 0.5;
  double width_m = 0.5;
  std::vector<PlaceConfig> places;
  StateConfig states;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("id", c.id, {.doc = "name in states.json"});
    v.field("length_m", c.length_m, {.doc = "along its heading", .unit = "m", .min = 0.01});
    v.field("width_m", c.width_m, {.doc = "across", .unit = "m", .min = 0.01});
    v.list("places", c.places, "where it can stand; absent is a state too");
    v.group("states", c.states, "when it stands where");
    v.require(!c.id.empty(), "id", "is missing", "name every box");
    v.require(!c.places.empty(), "places", "are missing", "give at least one place");
  }
};

/// Someone who walks to and fro along a chain of points; the laser sees two legs.
struct PersonConfig {
  std::vector<double> path;
  double speed_mps = 0.9;
  double pause_s = 2.0;
  double leg_radius_m = 0.07;
  double leg_spread_m = 0.24;
  double step_m = 0.6;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("path", c.path, {.doc = "x0, y0, x1, y1, ... walked to and fro", .unit = "m"});
    v.field("speed_mps", c.speed_mps, {.doc = "walking speed", .unit = "m/s", .min = 0.0});
    v.field("pause_s", c.pause_s, {.doc = "rest at each end", .unit = "s", .min = 0.0});
    v.field("leg_radius_m", c.leg_radius_m, {.doc = "of a leg", .unit = "m", .min = 0.01});
    v.field("leg_spread_m", c.leg_spread_m, {.doc = "between the legs", .unit = "m", .min = 0.0});
    v.field("step_m", c.step_m, {.doc = "length of a step", .unit = "m", .min = 0.01});
    v.require(c.path.size() >= 4 && c.path.size() % 2 == 0, "path",
              "is not two or more pairs of numbers", "write [x0, y0, x1, y1, ...]");
  }
};

/// A differential drive that follows waypoints and counts its own motion with errors.
struct RobotConfig {
  std::vector<double> route;
  int laps = 1;
  double speed_mps = 0.6;
  double turn_rate_rps = 1.2;
  double reach_m = 0.15;
  double personal_space_m = 0.55;
  double trans_noise = 0.02;
  double rot_noise = 0.02;
  double drift_rad_per_sqrt_m = 0.01;
  double scale_stddev = 0.02;
  double turn_scale_stddev = 0.02;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("route", c.route,
            {.doc = "x0, y0, x1, y1, ... waypoints of a lap", .unit = "m", .when = "always"});
    v.field("laps", c.laps, {.doc = "laps a day", .min = 1});
    v.field("speed_mps", c.speed_mps, {.doc = "driving speed", .unit = "m/s", .min = 0.01});
    v.field("turn_rate_rps", c.turn_rate_rps,
            {.doc = "greatest turn rate", .unit = "rad/s", .min = 0.01});
    v.field("reach_m", c.reach_m,
            {.doc = "a waypoint counts as reached from here", .unit = "m", .min = 0.01});
    v.field("personal_space_m", c.personal_space_m,
            {.doc = "people keep this far from the robot", .unit = "m", .min = 0.0});
    v.field("trans_noise", c.trans_noise,
            {.doc = "odometry: standard deviation of distance after 1 m", .unit = "m", .min = 0.0});
    v.field("rot_noise", c.rot_noise,
            {.doc = "odometry: standard deviation of heading after turning 1 rad",
             .unit = "rad",
             .min = 0.0});
    v.field("drift_rad_per_sqrt_m", c.drift_rad_per_sqrt_m,
            {.doc = "odometry: standard deviation of heading after driving 1 m",
             .unit = "rad",
             .min = 0.0});
    v.field("scale_stddev", c.scale_stddev,
            {.doc = "odometry: relative error of distances, one draw a day", .min = 0.0});
    v.field("turn_scale_stddev", c.turn_scale_stddev,
            {.doc = "odometry: relative error of turns, one draw a day", .min = 0.0});
    v.require(c.route.size() >= 2 && c.route.size() % 2 == 0, "route", "is not pairs of numbers",
              "write [x0, y0, x1, y1, ...]");
  }
};

/// A planar scanner whose beams are all measured at once.
struct LaserConfig {
  int beams = 180;
  double field_of_view_deg = 180.0;
  double rate_hz = 5.0;
  double range_min_m = 0.05;
  double range_max_m = 30.0;
  double noise_m = 0.01;
  double drop_probability = 0.005;
  double outlier_probability = 0.0;
  double mount_x_m = 0.1;
  double mount_y_m = 0.0;
  double mount_theta_deg = 0.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("beams", c.beams,
            {.doc = "a scan",
             .min = 1,
             .max = 100000,
             .when = "the scan shall be as that of your scanner"});
    v.field("field_of_view_deg", c.field_of_view_deg,
            {.doc = "split into one equal wedge a beam, measured in the wedge's middle",
             .unit = "deg",
             .min = 0.1,
             .max = 360.0});
    v.field("rate_hz", c.rate_hz, {.doc = "scans a second", .unit = "Hz", .min = 0.1, .max = 50.0});
    v.field("range_min_m", c.range_min_m, {.doc = "least range", .unit = "m", .min = 0.0});
    v.field("range_max_m", c.range_max_m, {.doc = "no return from here", .unit = "m", .min = 0.1});
    v.field("noise_m", c.noise_m,
            {.doc = "standard deviation of a range", .unit = "m", .min = 0.0});
    v.field("drop_probability", c.drop_probability,
            {.doc = "that a beam comes back as no return", .min = 0.0, .max = 1.0});
    v.field("outlier_probability", c.outlier_probability,
            {.doc = "that a beam ends anywhere before the obstacle", .min = 0.0, .max = 1.0});
    v.field("mount_x_m", c.mount_x_m, {.doc = "laser on the robot", .unit = "m"});
    v.field("mount_y_m", c.mount_y_m, {.doc = "laser on the robot", .unit = "m"});
    v.field("mount_theta_deg", c.mount_theta_deg, {.doc = "laser on the robot", .unit = "deg"});
    v.require(c.range_min_m < c.range_max_m, "range_min_m", "is not below range_max_m", "lower it");
  }
};

/// A whole scenario.
struct ScenarioConfig {
  std::string name = "scenario";
  int days = 1;
  double start_s = 1000.0;
  double night_s = 3600.0;
  std::vector<WallConfig> walls;
  std::vector<BlockConfig> blocks;
  std::vector<DoorConfig> doors;
  std::vector<BoxConfig> boxes;
  std::vector<PersonConfig> people;
  RobotConfig robot;
  LaserConfig laser;
  HeightsConfig heights;
  Scanner3Config scanner3;
  CameraConfig camera;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("name", c.name, {.doc = "what results call it"});
    v.field("days", c.days, {.doc = "how many times the robot drives its laps", .min = 1});
    v.field("start_s", c.start_s, {.doc = "stamp of the first scan", .unit = "s", .min = 0.0});
    v.field("night_s", c.night_s,
            {.doc = "without scans, after each day", .unit = "s", .min = 0.0});
    v.list("walls", c.walls, "thin walls");
    v.list("blocks", c.blocks, "solid rectangles");
    v.list("doors", c.doors, "doors");
    v.list("boxes", c.boxes, "boxes that change place");
    v.list("people", c.people, "people who walk about");
    v.group("robot", c.robot, "how it drives and how its odometry errs");
    v.group("laser", c.laser, "the scanner");
    v.group("heights", c.heights, "how high things are, for the 3-D scanner and the camera");
    v.group("scanner3", c.scanner3, "the 3-D scanner");
    v.group("camera", c.camera, "the camera");
  }
};

}  // namespace strata::simulate
