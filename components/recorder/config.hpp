// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::Recorder.
#pragma once

#include <string>
#include <vector>

#include "core/base/config.hpp"

namespace strata::recorder {

struct RecorderConfig {
  std::string out;
  std::vector<std::string> topics;
  std::string storage = "sqlite3";
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("out", c.out, {.doc = "bag folder to write"});
    v.require(!c.out.empty(), "out", "is missing", "name a folder, as in out: bag");
    v.field("topics", c.topics,
            {.doc = "topics to record, as /scan or, for one that nobody publishes yet, as "
                    "/scan:sensor_msgs/msg/LaserScan; empty: every topic there is"});
    v.field("storage", c.storage, {.doc = "sqlite3 or mcap"});
    v.require(c.storage == "sqlite3" || c.storage == "mcap", "storage", "is unknown",
              "choose sqlite3 or mcap");
  }
};

}  // namespace strata::recorder
