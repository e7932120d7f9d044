// SPDX-License-Identifier: Apache-2.0
/// The height of a scenario, and what looks at it: a 3-D scanner and a camera.
///
/// The planar laser sees a scenario as before; heights are for what follows.
#pragma once

#include <array>
#include <utility>

#include "core/base/config.hpp"

namespace strata::simulate {

enum class Scanner3Kind {
  kLayers,   ///< layers of beams, measured at one moment
  kTilting,  ///< a planar scanner that tilts from the lowest to the highest elevation in a sweep
};

}  // namespace strata::simulate

template <>
struct strata::EnumNames<strata::simulate::Scanner3Kind> {
  static constexpr std::array<std::pair<strata::simulate::Scanner3Kind, const char*>, 2> values{
      {{strata::simulate::Scanner3Kind::kLayers, "layers"},
       {strata::simulate::Scanner3Kind::kTilting, "tilting"}}};
};

namespace strata::simulate {

struct HeightsConfig {
  double ceiling_m = 2.6;
  double block_m = 0.9;
  double door_m = 2.0;
  double box_m = 0.6;
  double person_m = 1.75;
  double body_radius_m = 0.2;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("ceiling_m", c.ceiling_m, {.doc = "walls reach up to it", .unit = "m", .min = 0.5});
    v.field("block_m", c.block_m,
            {.doc = "of blocks that do not say their own", .unit = "m", .min = 0.01});
    v.field("door_m", c.door_m, {.doc = "of door leaves", .unit = "m", .min = 0.01});
    v.field("box_m", c.box_m, {.doc = "of boxes", .unit = "m", .min = 0.01});
    v.field("person_m", c.person_m, {.doc = "of people", .unit = "m", .min = 0.1});
    v.field("body_radius_m", c.body_radius_m,
            {.doc = "of a body, which begins where legs end, at 0.45 of the height",
             .unit = "m",
             .min = 0.01});
  }
};

struct Scanner3Config {
  double rate_hz = 0.0;
  Scanner3Kind kind = Scanner3Kind::kLayers;
  int layers = 32;
  int beams = 360;
  double field_of_view_deg = 360.0;
  double lowest_deg = -40.0;
  double highest_deg = 40.0;
  double sweep_s = 1.0;
  double range_max_m = 20.0;
  double noise_m = 0.01;
  double drop_probability = 0.005;
  double mount_x_m = 0.0;
  double mount_z_m = 1.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("rate_hz", c.rate_hz,
            {.doc = "clouds a second; 0: there is no 3-D scanner",
             .unit = "Hz",
             .min = 0.0,
             .max = 20.0});
    v.field("kind", c.kind,
            {.doc = "layers: measured at one moment; tilting: one layer after the other, each "
                    "point with its time"});
    v.field("layers", c.layers, {.doc = "of beams, a cloud", .min = 1, .max = 1000});
    v.field("beams", c.beams, {.doc = "a layer", .min = 1, .max = 100000});
    v.field("field_of_view_deg", c.field_of_view_deg,
            {.doc = "of a layer, about straight ahead", .unit = "deg", .min = 0.1, .max = 360.0});
    v.field("lowest_deg", c.lowest_deg,
            {.doc = "elevation of the first layer", .unit = "deg", .min = -90.0, .max = 90.0});
    v.field("highest_deg", c.highest_deg,
            {.doc = "elevation of the last layer", .unit = "deg", .min = -90.0, .max = 90.0});
    v.field("sweep_s", c.sweep_s,
            {.doc = "how long a tilting scanner takes from the first to the last layer",
             .unit = "s",
             .min = 0.0,
             .max = 60.0});
    v.field("range_max_m", c.range_max_m, {.doc = "no return from here", .unit = "m", .min = 0.1});
    v.field("noise_m", c.noise_m,
            {.doc = "standard deviation of a range", .unit = "m", .min = 0.0});
    v.field("drop_probability", c.drop_probability,
            {.doc = "that a beam comes back as no return (NaN)", .min = 0.0, .max = 1.0});
    v.field("mount_x_m", c.mount_x_m, {.doc = "scanner on the robot", .unit = "m"});
    v.field("mount_z_m", c.mount_z_m, {.doc = "above the floor", .unit = "m", .min = 0.0});
    v.require(c.lowest_deg <= c.highest_deg, "highest_deg", "is below lowest_deg", "raise it");
  }
};

struct CameraConfig {
  double rate_hz = 0.0;
  int width = 160;
  int height = 120;
  double field_of_view_deg = 90.0;
  double mount_x_m = 0.1;
  double mount_z_m = 1.2;
  double pitch_deg = 0.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field(
        "rate_hz", c.rate_hz,
        {.doc = "images a second; 0: there is no camera", .unit = "Hz", .min = 0.0, .max = 20.0});
    v.field("width", c.width, {.doc = "pixels", .min = 8, .max = 4096});
    v.field("height", c.height, {.doc = "pixels", .min = 8, .max = 4096});
    v.field("field_of_view_deg", c.field_of_view_deg,
            {.doc = "across the width", .unit = "deg", .min = 5.0, .max = 170.0});
    v.field("mount_x_m", c.mount_x_m, {.doc = "camera on the robot", .unit = "m"});
    v.field("mount_z_m", c.mount_z_m, {.doc = "above the floor", .unit = "m", .min = 0.0});
    v.field("pitch_deg", c.pitch_deg,
            {.doc = "downwards positive", .unit = "deg", .min = -80.0, .max = 80.0});
  }
};

}  // namespace strata::simulate
