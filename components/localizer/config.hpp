// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::Localizer.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "components/localizer/current_map_config.hpp"
#include "components/localizer/place_store.hpp"
#include "components/localizer/zone_topics.hpp"
#include "components/maps/map_model.hpp"
#include "components/runtime/common_settings.hpp"
#include "components/runtime/sensor_input.hpp"
#include "core/localization/level_choice.hpp"
#include "core/localization/localizer_config.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "core/refinement/pose_refiner.hpp"
#include "memory/decoding/decoding_config.hpp"
#include "memory/nodes/timescale_config.hpp"

namespace strata::localizer {

/// Where the robot is at the start. The defaults are those of `strata localize`.
struct StartConfig {
  std::vector<double> pose;
  std::string level;
  std::string pose_topic;
  double stddev_m = 0.2;
  double stddev_rad = 0.1;
  PlaceStoreConfig store;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("pose", c.pose,
            {.doc = "x, y [m], theta [rad] in the map frame; empty: anywhere, a global start",
             .when = "the robot always begins at the same place"});
    v.require(c.pose.empty() || c.pose.size() == 3, "pose", "is not three numbers",
              "write [x, y, theta]");
    v.field("level", c.level,
            {.doc = "maps of a building: on this level; empty: on any, which the scans tell"});
    v.field(
        "pose_topic", c.pose_topic,
        {.doc = "strata_msgs/ScanPose in, as scan_pose of a scan matcher: with maps from topics "
                "and no pose, begin at the last one from there; empty: a global start"});
    v.field("stddev_m", c.stddev_m, {.doc = "of x and of y", .unit = "m", .min = 0.0});
    v.field("stddev_rad", c.stddev_rad, {.doc = "of theta", .unit = "rad", .min = 0.0});
    v.group("store", c.store, "beginning where the robot was when the process ended");
  }
};

/// Where maps come from when no folder is named.
struct MapTopicsConfig {
  std::string occupancy = "map";
  std::string filtered = "reflection_filtered";
  std::string patches = "patch_map";
  std::string nodes = "node_map";
  std::string qos = "latched";
  bool follow = false;
  double own_place_m = memory::TimescaleConfig{}.visibility.own_place_m;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("occupancy", c.occupancy,
            {.doc = "nav_msgs/OccupancyGrid in, for the model occupancy: anybody's map"});
    v.field("filtered", c.filtered, {.doc = "strata_msgs/ReflectionGrid in, for all other models"});
    v.field("patches", c.patches, {.doc = "strata_msgs/PatchMap in, for the patch models"});
    v.field("nodes", c.nodes, {.doc = "strata_msgs/NodeMap in, for the timescale models"});
    v.field("qos", c.qos, {.doc = "QoS profile of the maps"});
    v.field(
        "follow", c.follow,
        {.doc = "with a folder: take newer maps over from the topics too, as of a patch learner "
                "that goes on learning"});
    v.field("own_place_m", c.own_place_m,
            {.doc = "as the timescale memory's own visibility", .unit = "m", .min = 0.0});
  }
};

/// Which pose goes out on pose_topic and as map -> odom.
enum class PoseOut {
  kFilter,   ///< the mean of the particles
  kRefined,  ///< the refined one, where there is one
};

/// Scans with the pose they were taken from, as long as that is well known.
struct LocatedScansConfig {
  double max_stddev_m = 0.1;
  double max_stddev_rad = 0.03;
  double min_score = 0.1;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.renamed("most_stddev_m", "max_stddev_m");
    v.field("max_stddev_m", c.max_stddev_m,
            {.doc = "only scans whose position is at least this certain", .unit = "m", .min = 0.0});
    v.renamed("most_stddev_rad", "max_stddev_rad");
    v.field("max_stddev_rad", c.max_stddev_rad,
            {.doc = "... and whose heading is", .unit = "rad", .min = 0.0});
    v.field(
        "min_score", c.min_score,
        {.doc = "... and whose pose has at least this score: a learner must not take up what was "
                "seen elsewhere",
         .min = 0.0,
         .max = 1.0});
  }
};

struct LocalizerComponentConfig {
  std::string maps;
  MapTopicsConfig map_topics;
  std::string model = "patch";
  StartConfig start;
  runtime::SensorInputConfig input;
  localization::LocalizerConfig localizer;
  localization::LevelChoiceConfig levels;
  maps::SensorModelKind sensor_model = maps::SensorModelKind::kBeam;
  patch_beams::PatchBeamModelConfig sensor;
  localization::LikelihoodFieldModelConfig likelihood_field;
  memory::DecodingConfig decoding;
  maps::TimescaleUseConfig timescale_use;
  std::string initial_pose_topic = "initialpose";
  std::string pose_topic = "amcl_pose";
  std::string refined_topic = "refined_pose";
  PoseOut pose = PoseOut::kFilter;
  refinement::RefinementConfig refinement;
  std::string particles_topic = "particle_cloud";
  std::string candidates_topic = "place_candidates";
  std::string states_topic = "submap_states";
  std::string current_map_topic = "map_current";
  CurrentMapConfig current_map;
  ChangeMaskConfig change_mask;
  std::string health_topic = "localization_health";
  std::string score_topic = "localization_score";
  double restore_point_s = 10.0;
  double restore_point_mb = 32.0;
  std::string located_topic;
  LocatedScansConfig located;
  std::string map_frame = "map";
  std::string odometry_frame = "odom";
  bool publish_tf = true;
  std::string sensor_qos = "sensor_data";
  double transform_tolerance = 1.0;
  std::string pose_qos = "latched";
  std::string initial_pose_qos = "default";
  std::string state_qos = "latched";
  std::string out_subfolder;
  bool site_changes = true;
  ZoneTopicsConfig zones;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field(
        "maps", c.maps,
        {.doc =
             "folder that `strata learn` or mapping.yaml wrote, or a site (`strata site`), whose "
             "active version is used, and the next one when another is activated, and whose "
             "level is found where it has several; its sub-maps go "
             "out on ~/patch_map (strata_msgs/PatchMap); empty: maps come over topics, and the "
             "robot is localized from when they are there",
         .when = "always, unless maps come over topics"});
    v.group("map_topics", c.map_topics, "where maps come from when no folder is named");
    v.field("model", c.model,
            {.doc = maps::model_doc(),
             .when = "the default fits buildings with doors and furniture that move; occupancy for "
                     "a map of somebody else, filtered for one without people, timescale for "
                     "change that never settles"});
    v.group("start", c.start, "where the robot is at the start");
    v.group("input", c.input, "where scans and odometry come from");
    v.group("localizer", c.localizer, "the particle filter");
    v.group("levels", c.levels, "maps of a building: when a level is believed");
    v.field(
        "sensor_model", c.sensor_model,
        {.doc = maps::sensor_model_doc(),
         .when = "the map is occupancy or filtered and time is short: likelihood_field is faster"});
    v.group("sensor", c.sensor, "what beams measure in a map");
    v.group("likelihood_field", c.likelihood_field, "the sensor model likelihood_field");
    v.group("decoding", c.decoding,
            "how levels of the memory in the maps folder become expected scans; those from "
            "map_topics.nodes are decoded where the memory is");
    v.group("timescale_use", c.timescale_use, "how the timescale memory is used");
    v.field("initial_pose_topic", c.initial_pose_topic,
            {.doc = "geometry_msgs/PoseWithCovarianceStamped in: start again from there"});
    v.field("pose_topic", c.pose_topic,
            {.doc = "geometry_msgs/PoseWithCovarianceStamped out, one a scan"});
    v.field(
        "refined_topic", c.refined_topic,
        {.doc = "geometry_msgs/PoseWithCovarianceStamped out, where a scan's pose was refined"});
    v.field("pose", c.pose,
            {.doc = "what goes out on pose_topic and as map -> odom; refined: where a scan's pose "
                    "was not, the filter's, so that it may step by a few centimetres"});
    v.group("refinement", c.refinement, "poses finer than the filter's");
    v.field("particles_topic", c.particles_topic,
            {.doc = "nav2_msgs/ParticleCloud out, made when somebody reads it"});
    v.field(
        "candidates_topic", c.candidates_topic,
        {.doc =
             "nav2_msgs/ParticleCloud out: the places that are still possible while the pose "
             "is ambiguous (localizer.global_search), with their probabilities; once empty when it "
             "no longer is"});
    v.field("states_topic", c.states_topic, {.doc = "strata_msgs/SubmapStates out"});
    v.field("current_map_topic", c.current_map_topic,
            {.doc = "nav_msgs/OccupancyGrid out: how likely each cell is occupied now, in percent, "
                    "by what "
                    "is believed of the sub-maps, whenever that changes"});
    v.group("current_map", c.current_map, "when the current map goes out again");
    v.group("change_mask", c.change_mask, "what often changes, for nav2's costmap filters");
    v.field("health_topic", c.health_topic, {.doc = "strata_msgs/LocalizationHealth out"});
    v.field(
        "score_topic", c.score_topic,
        {.doc = "std_msgs/Float64 out, one a scan: the probability that the pose is within 0.5 m "
                "of the truth"});
    v.field("restore_point_s", c.restore_point_s,
            {.doc = "live, while somebody records ~/_restore_point and ~/_journal, as an incident "
                    "recorder does: so often the filter is kept there, from which `strata "
                    "incidents replay` goes on to the same bits; 0: never",
             .unit = "s",
             .min = 0.0});
    v.field("restore_point_mb", c.restore_point_mb,
            {.doc = "... as long as what a model has learned while it localized takes no more than "
                    "this in one; else its incidents are not replayed, which /diagnostics says",
             .unit = "MB",
             .min = 0.0});
    v.field("located_topic", c.located_topic,
            {.doc = "strata_msgs/LabeledScan out: scans with their poses for learners that go on "
                    "learning, such as located_scan; empty: none"});
    v.group("located", c.located, "which scans go out with their poses");
    v.field("map_frame", c.map_frame, runtime::kMapFrame);
    v.field("odometry_frame", c.odometry_frame, runtime::kOdometryFrame);
    v.field("publish_tf", c.publish_tf, runtime::kPublishTf);
    v.field("transform_tolerance", c.transform_tolerance,
            {.doc = "by so much the broadcast is dated after its scan: so long it may be used, as "
                    "by who looks up where the robot is now",
             .unit = "s",
             .min = 0.0,
             .max = 60.0});
    v.field("sensor_qos", c.sensor_qos,
            {.doc = "QoS profile of scan, odometry and particles: default, sensor_data, ..."});
    v.field("pose_qos", c.pose_qos, {.doc = "QoS profile of pose_topic"});
    v.field("initial_pose_qos", c.initial_pose_qos, {.doc = "QoS profile of initial_pose_topic"});
    v.field("state_qos", c.state_qos,
            {.doc = "QoS profile of sub-map states, the current map and health"});
    v.field("out_subfolder", c.out_subfolder,
            {.doc = "replay: folder inside --out for this component's files; empty: --out itself"});
    v.field("site_changes", c.site_changes,
            {.doc = "maps of a site: ~/approve_version, ~/activate_version and ~/roll_back decide "
                    "on its versions; else they are refused, and the site is only told of"});
    v.group("zones", c.zones, "maps of a site: its zones, for nav2's costmap filters");
  }
};

}  // namespace strata::localizer

template <>
struct strata::EnumNames<strata::localizer::PoseOut> {
  static constexpr std::array<std::pair<strata::localizer::PoseOut, const char*>, 2> values{
      {{strata::localizer::PoseOut::kFilter, "filter"},
       {strata::localizer::PoseOut::kRefined, "refined"}}};
};
