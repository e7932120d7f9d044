// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::Recorder.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "components/log/bag.hpp"
#include "core/base/config.hpp"

template <>
struct strata::EnumNames<strata::log::BagStorage> {
  static constexpr std::array<std::pair<strata::log::BagStorage, const char*>, 2> values{
      {{strata::log::BagStorage::kSqlite3, "sqlite3"}, {strata::log::BagStorage::kMcap, "mcap"}}};
};
template <>
struct strata::EnumNames<strata::log::BagCompression> {
  static constexpr std::array<std::pair<strata::log::BagCompression, const char*>, 3> values{
      {{strata::log::BagCompression::kNone, "none"},
       {strata::log::BagCompression::kZstd, "zstd"},
       {strata::log::BagCompression::kLz4, "lz4"}}};
};

namespace strata::recorder {

struct RecorderConfig {
  std::string out;
  bool number_if_exists = false;
  std::vector<std::string> topics;
  log::BagStorage storage = log::BagStorage::kSqlite3;
  log::BagCompression compression = log::BagCompression::kNone;
  int sqlite_schema = 3;
  double split_mb = 0.0;
  double split_s = 0.0;
  bool paused = false;
  int latched_depth = 1;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("out", c.out, {.doc = "folder to write", .when = "always"});
    v.require(!c.out.empty(), "out", "is missing", "name a folder, as in out: bag");
    v.field(
        "number_if_exists", c.number_if_exists,
        {.doc = "where out exists already, as after a restart, record into out_2, out_3 and so on "
                "beside it; else that is an error"});
    v.field("topics", c.topics,
            {.doc = "topics to record, as /scan or, for one that nobody publishes yet, as "
                    "/scan:sensor_msgs/msg/LaserScan; empty: every topic there is",
             .when = "not everything is wanted, or disk space is short"});
    v.field("storage", c.storage, {.doc = "rosbag2's storage"});
    v.field("compression", c.compression, {.doc = "of the chunks of mcap"});
    v.require(c.storage == log::BagStorage::kMcap || c.compression == log::BagCompression::kNone,
              "compression", "is for mcap only", "leave it out, or choose storage: mcap");
    v.field("sqlite_schema", c.sqlite_schema,
            {.doc = "3 as ROS 2 Humble writes, 4 as Iron and later", .min = 3, .max = 4});
    v.field(
        "split_mb", c.split_mb,
        {.doc = "begin another file when one holds this much; 0: never", .unit = "MB", .min = 0.0});
    v.field("split_s", c.split_s,
            {.doc = "... or spans this time; 0: never", .unit = "s", .min = 0.0});
    v.field("paused", c.paused,
            {.doc = "record when resumed; may be changed while it records: what comes meanwhile is "
                    "left out"});
    v.field("latched_depth", c.latched_depth,
            {.doc = "latched messages (maps, /tf_static) that come while paused are recorded when "
                    "resumed: the last so many of each writer",
             .min = 0,
             .max = 1000});
  }
};

}  // namespace strata::recorder
