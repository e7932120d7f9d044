// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::PatchLearner.
#pragma once

#include <string>

#include "components/runtime/common_settings.hpp"
#include "core/patch/online_learner.hpp"
#include "core/patch/patch_learner.hpp"

namespace strata::patch_learner {

/// Where an online learner keeps what it has learned.
struct LearnerStoreConfig {
  std::string folder;
  double state_period_s = 300.0;
  double save_period_s = 0.5;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("folder", c.folder,
            {.doc = "live: keep what is learned in this folder while the robot runs, and go on "
                    "with what it holds; empty: in RAM only",
             .when = "learning shall go on after a restart"});
    v.field("state_period_s", c.state_period_s,
            {.doc = "all of it is written this often, by the stamps of the scans; what a start has "
                    "to learn again is no longer than this",
             .unit = "s",
             .min = 1.0});
    v.field("save_period_s", c.save_period_s,
            {.doc = "new scans are written this often: what a crash may lose at most",
             .unit = "s",
             .min = 0.0,
             .max = 60.0});
  }
};

/// Learning that never ends: see core/patch/online_learner.hpp.
struct OnlineLearningConfig {
  bool enabled = true;
  patch::OnlineConfig learner;
  std::string scan_topic = "labeled_scan";
  std::string trajectory_topic = "trajectory";
  std::string maps;
  double publish_every_s = 10.0;
  LearnerStoreConfig store;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field(
        "enabled", c.enabled,
        {.doc = "learn scan by scan while the robot works, and publish the map when it changes; "
                "false: keep every scan. In lockstep without `maps` all is learned at the end of "
                "the log, as `strata learn` does"});
    v.group("learner", c.learner, "what is kept, and how often changes are looked for");
    v.field("scan_topic", c.scan_topic,
            {.doc = "strata_msgs/LabeledScan in: labeled_scan of a beam filter (poses of SLAM), or "
                    "located_scan of a localizer, which works in a learned map"});
    v.field("trajectory_topic", c.trajectory_topic,
            {.doc = "nav_msgs/Path in, as a scan matcher's: where scans are known to have been "
                    "taken since a loop was closed; empty: scans stay where they came"});
    v.field("maps", c.maps,
            {.doc = "folder to go on from: its filtered map, and the scans it was learned from; "
                    "empty: begin with nothing, on the map from reflection_filtered",
             .when = "the robot works in a map that strata learn made"});
    v.field("publish_every_s", c.publish_every_s,
            {.doc = "a changed map is published no more often than this, or as seldom as keeps it "
                    "to a twentieth of the time",
             .unit = "s",
             .min = 0.0});
    v.group("store", c.store, "going on after the process has ended");
  }
};

struct PatchLearnerComponentConfig {
  patch::PatchLearnerConfig patch;
  OnlineLearningConfig online;
  std::string zones;
  std::string map_frame = "map";
  int learn_every_scans = 0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("patch", c.patch, "sub-maps and their configurations");
    v.group("online", c.online, "learning while the robot works");
    v.field(
        "zones", c.zones,
        {.doc = "a site, or a GeoJSON file, whose zones of kind learn are obeyed: where nothing "
                "is learned, and where nothing changes; read when it is configured; empty: "
                "none"});
    v.field("map_frame", c.map_frame, runtime::kMapFrame);
    v.field("learn_every_scans", c.learn_every_scans,
            {.doc = "live and not online: learn anew from all scans after so many; 0: never. Takes "
                    "seconds",
             .unit = "scans",
             .min = 0.0});
  }
};

}  // namespace strata::patch_learner
