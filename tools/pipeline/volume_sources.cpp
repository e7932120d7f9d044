// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/volume_sources.hpp"

#include <memory>

#include "components/log/log_reader.hpp"
#include "components/log/trajectory_file.hpp"
#include "core/base/error.hpp"
#include "tools/pipeline/runs_input.hpp"

namespace fs = std::filesystem;

namespace strata::pipeline {
namespace {

volume::SensorPoses poses_from(log::TransformHistory history, const std::string& robot_frame) {
  const auto shared = std::make_shared<const log::TransformHistory>(std::move(history));
  return [shared, robot_frame](Stamp stamp) { return shared->find("map", robot_frame, stamp); };
}

/// SLAM over the planar scans: at known poses, or to find them.
slam::SlamResult map_plane(const std::vector<Observation>& observations,
                           const volume::SensorPoses& known, const slam::SlamConfig& config,
                           int threads, Progress* progress) {
  slam::Slam slam(config, threads);
  for (std::size_t i = 0; i < observations.size(); ++i) {
    report_progress(progress, "match scans", i, observations.size());
    if (!known) {
      slam.add(observations[i]);
    } else if (const auto pose = known(observations[i].scan.stamp)) {
      const Pose2 given = planar(*pose);
      slam.add(observations[i], &given);
    }
  }
  return slam.finish(progress);
}

}  // namespace

MovingKind resolve_moving(MovingKind moving, bool has_scans, bool remember) {
  if (moving != MovingKind::kAuto) return moving;
  if (!has_scans) return MovingKind::kVoxels;
  return remember ? MovingKind::kBoxes : MovingKind::kBoth;
}

VolumeSources find_volume_sources(const fs::path& log, const std::string& poses, MovingKind asked,
                                  bool remember, const slam::SlamConfig& slam, int threads,
                                  Progress* progress) {
  VolumeSources sources;
  const bool wants_boxes = asked == MovingKind::kBoxes || asked == MovingKind::kBoth;
  if (!clouds::is_bag(log)) {
    if (!poses.empty()) {
      throw InputError("--poses " + poses, "does not go with a log whose clouds have poses",
                       "leave --poses out");
    }
    if (wants_boxes) {
      throw InputError(log.string(), "has no planar scans to make boxes from",
                       "use --moving voxels");
    }
    sources.pose_source = "log";
    sources.uses_voxels = asked != MovingKind::kNone;
    return sources;
  }
  const clouds::BagPoses bag(log, {});
  if (bag.topics_of("sensor_msgs/msg/PointCloud2").empty()) {
    throw InputError(log.string(), "holds no point clouds, so there is no 3-D map in it",
                     "record a topic of sensor_msgs/msg/PointCloud2; of scans `strata learn` makes "
                     "maps");
  }
  const bool has_scans = !bag.topics_of("sensor_msgs/msg/LaserScan").empty();
  if (wants_boxes && !has_scans) {
    throw InputError(log.string(), "has no planar scans to make boxes from", "use --moving voxels");
  }
  const MovingKind moving = resolve_moving(asked, has_scans, remember);
  sources.uses_boxes = moving == MovingKind::kBoxes || moving == MovingKind::kBoth;
  sources.uses_voxels = moving == MovingKind::kVoxels || moving == MovingKind::kBoth;

  std::string& robot_frame = sources.reading.robot_frame;
  log::LogContent content;
  if (has_scans) {
    log::ReadOptions reading;
    reading.progress = progress;
    log::ReadReport report;
    content = log::read_log(log, reading);
    bring_near(content.observations, log.string(), report);
    sources.warnings = std::move(report.warnings);
    robot_frame = content.robot_frame;
  }
  volume::SensorPoses known;
  if (!poses.empty()) {
    sources.pose_source = "poses";
    known = sources.reading.robot_poses =
        poses_from(log::read_space_trajectory(poses, robot_frame), robot_frame);
  } else if (bag.knows_map()) {
    sources.pose_source = "tf";
    known = [&](Stamp stamp) { return bag.find(robot_frame, stamp); };
  } else if (has_scans) {
    sources.pose_source = "slam";
  } else {
    sources.pose_source = "tf";
  }
  if (!sources.uses_boxes && sources.pose_source != "slam") return sources;

  slam::SlamResult plane = map_plane(content.observations, known, slam, threads, progress);
  sources.scans = std::move(plane.scans);
  sources.warnings.insert(sources.warnings.end(), plane.warnings.begin(), plane.warnings.end());
  if (sources.pose_source == "slam") {
    log::TransformHistory history;
    for (const PosedScan& scan : sources.scans) {
      history.add("map", robot_frame, scan.scan.stamp, lift(scan.map_from_robot));
    }
    sources.reading.robot_poses = poses_from(std::move(history), robot_frame);
  }
  return sources;
}

}  // namespace strata::pipeline
