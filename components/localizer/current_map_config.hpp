// SPDX-License-Identifier: Apache-2.0
/// Settings of the map as it is believed to be now, and of the mask of what often changes.
#pragma once

#include <array>
#include <string>
#include <utility>

#include "core/base/config.hpp"

namespace strata::localizer {

struct CurrentMapConfig {
  double noticeable = 0.1;
  double min_period_s = 1.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("noticeable", c.noticeable,
            {.doc = "the map goes out again when the square root of a configuration's probability "
                    "has moved by so much: at 0.1 by 0.13 from even odds, by 0.01 from 0",
             .min = 0.001,
             .max = 1.0});
    v.field("min_period_s", c.min_period_s,
            {.doc = "... but not more often than this, by the stamps of scans; a new map goes out "
                    "at once",
             .unit = "s",
             .min = 0.0});
  }
};

/// What nav2 does with the mask.
enum class ChangeMaskKind {
  kOff,      ///< there is none
  kPenalty,  ///< KeepoutFilter: what may change costs more
  kSpeed,    ///< SpeedFilter: where it may change the robot is slow
};

struct ChangeMaskConfig {
  ChangeMaskKind kind = ChangeMaskKind::kOff;
  std::string topic = "change_mask";
  std::string info_topic = "change_mask_info";
  double horizon_s = 300.0;
  double reach_m = 0.3;
  int max_penalty = 99;
  double min_speed = 30.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("kind", c.kind,
            {.doc = "penalty: for nav2's KeepoutFilter, in which what may change costs more; "
                    "speed: for its SpeedFilter, the slower the likelier a change is; models "
                    "without sub-maps have no mask"});
    v.field("topic", c.topic,
            {.doc = "nav_msgs/OccupancyGrid out, with each map on current_map_topic: how likely it "
                    "is that a place is otherwise now, or within the horizon, than it is likeliest "
                    "to be now, in percent"});
    v.field("info_topic", c.info_topic,
            {.doc = "nav2_msgs/CostmapFilterInfo out, once: what the mask means"});
    v.field("horizon_s", c.horizon_s,
            {.doc = "as long as the robot may be on its way there", .unit = "s", .min = 0.0});
    v.field("reach_m", c.reach_m,
            {.doc = "around cells that may change it holds too, as for the robot's middle while it "
                    "passes",
             .unit = "m",
             .min = 0.0,
             .max = 2.0});
    v.field("max_penalty", c.max_penalty,
            {.doc = "penalty: of what is sure to change; 99 makes percent of the probability, 100 "
                    "would be a wall",
             .unit = "%",
             .min = 1,
             .max = 99});
    v.field("min_speed", c.min_speed,
            {.doc = "speed: there, of the greatest speed; 0 would be no limit to nav2",
             .unit = "%",
             .min = 1.0,
             .max = 100.0});
  }
};

}  // namespace strata::localizer

template <>
struct strata::EnumNames<strata::localizer::ChangeMaskKind> {
  static constexpr std::array<std::pair<strata::localizer::ChangeMaskKind, const char*>, 3> values{
      {{strata::localizer::ChangeMaskKind::kOff, "off"},
       {strata::localizer::ChangeMaskKind::kPenalty, "penalty"},
       {strata::localizer::ChangeMaskKind::kSpeed, "speed"}}};
};
