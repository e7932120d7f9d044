// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::Player.
#pragma once

#include <string>

#include "core/base/config.hpp"

namespace strata::player {

struct PlayerConfig {
  std::string log;
  double rate = 1.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("log", c.log, {.doc = "the log to play: CARMEN, rosbag2 or MCAP"});
    v.require(!c.log.empty(), "log", "is missing", "name a log, as in log: office.clf");
    v.field("rate", c.rate, {.doc = "1: as fast as recorded; 2: twice", .unit = "1", .min = 1e-3});
  }
};

}  // namespace strata::player
