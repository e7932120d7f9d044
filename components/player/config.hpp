// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::Player.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "core/base/config.hpp"

namespace strata::player {

/// What is made of a log.
enum class PlayMode {
  kRobot,     ///< its scans, with odometry, tf and clock, as a robot would publish them
  kMessages,  ///< every message of a bag as it was recorded, of whatever type
};

}  // namespace strata::player

template <>
struct strata::EnumNames<strata::player::PlayMode> {
  static constexpr std::array<std::pair<strata::player::PlayMode, const char*>, 2> values{
      {{strata::player::PlayMode::kRobot, "robot"},
       {strata::player::PlayMode::kMessages, "messages"}}};
};

namespace strata::player {

struct PlayerConfig {
  std::string log;
  PlayMode mode = PlayMode::kRobot;
  std::vector<std::string> topics;
  std::vector<std::string> scan_topics;
  double rate = 1.0;
  double start_s = 0.0;
  bool loop = false;
  bool paused = false;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("log", c.log,
            {.doc = "the log to play: CARMEN, rosbag2, MCAP or a ROS 1 bag", .when = "always"});
    v.require(!c.log.empty(), "log", "is missing", "name a log, as in log: office.clf");
    v.field(
        "mode", c.mode,
        {.doc = "robot: scans with odometry, tf and clock; messages: all of a bag, of any type, "
                "with the QoS it was recorded with, and a clock"});
    v.field("topics", c.topics, {.doc = "mode messages: only these; empty: all"});
    v.require(c.topics.empty() || c.mode == PlayMode::kMessages, "topics",
              "is for mode: messages, and a robot's topics are made",
              "leave it out, or play a bag "
              "in mode: messages");
    v.field("scan_topics", c.scan_topics,
            {.doc = "mode robot: topics of the bag's scanners; all go out on `scan`, each in its "
                    "own frame; empty: the only one, or /scan"});
    v.field("rate", c.rate,
            {.doc = "1: as fast as recorded; 2: twice; may be changed while it plays",
             .unit = "1",
             .min = 1e-3,
             .max = 1e6,
             .when = "a log shall play faster or slower than it was recorded"});
    v.field("start_s", c.start_s, {.doc = "begin there", .unit = "s", .min = 0.0, .max = 4e9});
    v.field("loop", c.loop, {.doc = "begin again at the end"});
    v.field("paused", c.paused, {.doc = "begin when resumed; may be changed while it plays"});
  }
};

}  // namespace strata::player
