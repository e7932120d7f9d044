// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::IncidentRecorder.
#pragma once

#include <string>
#include <vector>

#include "core/base/config.hpp"

namespace strata::incident_recorder {

struct IncidentTriggerConfig {
  bool on_lost = true;
  bool on_outdated = true;
  bool on_recovery = true;
  bool on_error = true;
  double score_below = 0.3;
  std::vector<std::string> sources = {};
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("on_lost", c.on_lost, {.doc = "a localizer's verdict becomes lost"});
    v.field("on_outdated", c.on_outdated, {.doc = "... or says that the map is outdated here"});
    v.field("on_recovery", c.on_recovery,
            {.doc = "... or it doubts its pose and looks for the robot elsewhere"});
    v.field("on_error", c.on_error,
            {.doc = "any component's status on /diagnostics becomes an error: a scanner that is "
                    "silent, a disk that is full, a watchdog of others"});
    v.field("score_below", c.score_below,
            {.doc = "a localization score falls below this, after it was well above; 0: never",
             .min = 0.0,
             .max = 1.0});
    v.field("sources", c.sources,
            {.doc = "nodes (localizer, robot1/localizer) and namespaces (robot1) whose statuses "
                    "begin incidents; empty: all, of a recorder in a namespace all but nodes in "
                    "others, where robots share one /diagnostics"});
  }
};

struct IncidentRecorderConfig {
  std::string out;
  std::vector<std::string> topics;
  std::vector<std::string> keep_files;
  bool keep_maps = true;
  double before_s = 60.0;
  double after_s = 30.0;
  double memory_mb = 256.0;
  double disk_mb = 2000.0;
  double rest_s = 60.0;
  IncidentTriggerConfig when;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("out", c.out, {.doc = "folder to write", .when = "always"});
    v.require(!c.out.empty(), "out", "is missing", "name a folder, as in out: incidents");
    v.field("topics", c.topics,
            {.doc = "topics to keep; empty: every topic there is. /diagnostics is always kept. "
                    "Camera and cloud topics fill memory"});
    v.field(
        "keep_files", c.keep_files,
        {.doc = "files and folders (the composition, what nav2 is set to) of which each incident "
                "keeps a copy; contents that are equal are kept once"});
    v.field("keep_maps", c.keep_maps,
            {.doc = "the folders of maps that localizers use, where they are on this machine, are "
                    "kept so too"});
    v.field("before_s", c.before_s,
            {.doc = "so much of what came before the incident is kept",
             .unit = "s",
             .min = 0.0,
             .max = 3600.0});
    v.field("after_s", c.after_s,
            {.doc = "... and of what comes after it", .unit = "s", .min = 0.0, .max = 3600.0});
    v.field("memory_mb", c.memory_mb,
            {.doc = "messages in memory take at most this; older ones go first",
             .unit = "MB",
             .min = 1.0});
    v.field("disk_mb", c.disk_mb,
            {.doc = "all incidents together take at most this; older ones are removed first",
             .unit = "MB",
             .min = 1.0});
    v.field("rest_s", c.rest_s,
            {.doc = "after an incident nothing but the service begins another for so long",
             .unit = "s",
             .min = 0.0});
    v.group("when", c.when, "what begins an incident");
  }
};

}  // namespace strata::incident_recorder
