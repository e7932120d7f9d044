// SPDX-License-Identifier: Apache-2.0
// What Slam holds; only its own .cpp files see it.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/slam/local_map_graph.hpp"
#include "core/slam/log_checks.hpp"
#include "core/slam/slam.hpp"
#include "core/tracking/tracker.hpp"

namespace strata::slam {

/// A run in which no scan hit anything has none.
inline constexpr std::size_t kNoLocalMap = std::numeric_limits<std::size_t>::max();

/// One accepted scan and what is known of its pose.
struct Record {
  std::size_t number = 0;  // of all scans that were accepted
  PosedScan posed;
  Pose2 run_from_robot;
  std::optional<Pose2> odometry;
  std::optional<Pose2> given;
  bool placed = false;  // given by an earlier job, and final
  bool key = false;
  bool used = false;  // its scan is in the result
  std::size_t local_map = kNoLocalMap;

  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.number);
    archive(self.posed);
    archive(self.run_from_robot);
    archive(self.odometry);
    archive(self.given);
    archive(self.placed);
    archive(self.key);
    archive(self.local_map);
  }
};

/// Beside the maps of the next pass they would be the most memory of all.
void forget_maps(SlamResult& result);

/// Poses of a pass over the log that another one may not replace.
struct EarlierPass {
  std::vector<Pose2> poses;
  std::vector<Stamp> stamps;
  std::vector<bool> mapped;
  std::vector<bool> moves;
  Consistency consistency;
  std::size_t loop_closures = 0;
  std::vector<std::string> warnings;

  /// Tracking again has to make the map consistent, or at least much more so.
  [[nodiscard]] bool is_preferred_to(const Consistency& now) const;
  /// Loops that were found in a wider search have to do that without making ways agree in fewer
  /// cells, or to make them agree in clearly more, those that contradict taken off: where poses
  /// were far off, much of what contradicts now was not compared before.
  [[nodiscard]] bool is_outdone_by(const Consistency& now) const;
  /// Whether the result has the same scans.
  [[nodiscard]] bool is_of(const SlamResult& result) const;
};

struct Slam::State {
  State(const SlamConfig& slam_config, int threads, const KeepConfig& keep_config)
      : config(slam_config),
        keep(keep_config),
        pool(threads),
        graph(slam_config.closure, slam_config.tracking.match, slam_config.tracking.field,
              slam_config.beam_filter.resolution_m, pool) {}

  SlamConfig config;
  KeepConfig keep;
  WorkerPool pool;
  LocalMapGraph graph;
  std::optional<Tracker> tracker;
  std::vector<Record> records;  // by number, without those that are forgotten
  std::size_t accepted = 0;
  bool forgot = false;
  Unplaced unplaced;
  int run = 0;
  int runs = 0;
  std::vector<bool> mapped;   // of the scans in the result
  std::vector<bool> moves;    // those that do not keep the pose they came with
  bool run_is_given = false;  // the run's frame is that of its given poses
  Stamp last_stamp;
  LogChecks checks;
  Pose2 map_from_run;                       // as the newest local map of the run has it
  std::optional<Pose2Gaussian> next_start;  // where the next run begins, when that is known
  std::optional<Pose2Gaussian> start;       // where this one began, until it has a local map
  std::vector<std::pair<int, Pose2Gaussian>> begun_at;  // the runs whose start was known

  Pose2Gaussian add(const Observation& observation, const Pose2* given_pose, bool placed,
                    std::span<const float> static_probability = {});
  /// The map of all that was added, after so many rounds of EM at most.
  [[nodiscard]] SlamResult finish(int rounds, Progress* progress);
  /// Rounds of EM from the poses as they are.
  void improve(SlamResult& result, int rounds, Progress* progress);
  /// What beams without return say, for the maps at the poses as they are.
  void free_along_no_returns(SlamResult& result, Progress* progress);
  void track_again(SlamResult& before, State& again);
  [[nodiscard]] EarlierPass pass_of(const SlamResult& result);
  /// The map of the earlier pass instead, of the same scans.
  void go_back(const EarlierPass& before, SlamResult& result, Progress* progress);
  void start_run(const Observation& observation, const Pose2* given_pose);
  void end_run();
  void take_local_maps();
  /// Those of the scans of these numbers that are kept.
  [[nodiscard]] std::span<Record> numbered(std::size_t first, std::size_t last);
  void forget_local_maps();
  /// Those that own scans of `gone`; the others' indices move down. How many went.
  std::size_t drop_scans_of(const std::vector<std::size_t>& gone);
  /// Of runs whose last scan has gone.
  void forget_starts();
  void forget_scans();
  void place_scans();
  /// Everything but the tracker and what this process alone tells of, for saved states; what
  /// `finish` makes is not in it.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.graph);
    archive(self.records);
    archive(self.accepted);
    archive(self.forgot);
    archive(self.run);
    archive(self.runs);
    archive(self.run_is_given);
    archive(self.last_stamp);
    archive(self.checks);
    archive(self.map_from_run);
    archive(self.next_start);
    archive(self.start);
    archive(self.begun_at);
  }
  [[nodiscard]] std::optional<Pose2Gaussian> given_local_map(const LocalMap& local_map);
  /// A given pose, or one that an earlier job placed, as far as it is believed.
  [[nodiscard]] Pose2Gaussian believed(const Pose2& given, bool placed) const;
  /// Without any local map the first run's frame is the map's: odometry is better than nothing.
  [[nodiscard]] bool located(const Record& record) const {
    if (record.local_map != kNoLocalMap) return graph.located(record.local_map);
    return graph.size() == 0 && record.posed.run == records.front().posed.run;
  }
  /// Where it was taken, as known while scans come; nothing as long as its run is not placed.
  [[nodiscard]] std::optional<Pose2> pose_now(const Record& record) const;
  void visit(bool keys_only, const std::function<void(const Mapped&)>& visit) const;
  /// Whether the scan keeps the pose it came with.
  [[nodiscard]] bool stays(const Record& record) const {
    const GivenPoseConfig& given = config.given_poses;
    const bool refined = given.refine && (runs > 1 || given.refine_alone);
    return record.given && (record.placed || !refined);
  }
};

}  // namespace strata::slam
