// SPDX-License-Identifier: Apache-2.0
#include "core/topology/topology_mapper.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "core/topology/place_names.hpp"
#include "core/tracking/tracker.hpp"

namespace strata::topology {

struct TopologyMapper::State {
  State(const TopologyMapperConfig& mapper_config, std::uint64_t seed, int thread_count,
        const PathKeepConfig& keep_config)
      : config(mapper_config),
        keep(keep_config),
        maker(mapper_config.landmarks),
        filter(mapper_config.topology, seed, thread_count),
        threads(thread_count) {}

  TopologyMapperConfig config;
  PathKeepConfig keep;
  std::optional<slam::Tracker> tracker;
  VisitMaker maker;
  TopologyFilter filter;
  PlaceNames names;
  int threads = 1;
  std::vector<PosedScan> scans;
  std::vector<MadeVisit> visits;
  std::size_t skipped = 0;
  std::size_t tracked = 0;
  std::size_t kept_bytes = 0;
  std::optional<TrackedMoment> newest;
  bool is_begun = false;               // a scan came that was not restored
  bool has_odometry = false;           // such a scan had odometry
  std::optional<Pose2> run_from_odom;  // nothing: the same, unless the mapper was restored

  [[nodiscard]] bool is_full() const {
    return keep.memory_mb > 0.0 && static_cast<double>(kept_bytes) >= keep.memory_mb * 1e6;
  }

  [[nodiscard]] bool is_beside_last(const Pose2& pose) const {
    if (scans.empty()) return false;
    const Pose2 step = between(scans.back().map_from_robot, pose);
    return step.translation().norm() < keep.subsample_m &&
           std::abs(step.theta) < keep.subsample_rad;
  }

  [[nodiscard]] std::vector<MadeVisit> keep_scan(const PosedScan& scan) {
    kept_bytes += sizeof(PosedScan) + scan.scan.ranges_m.size() * sizeof(float);
    scans.push_back(scan);
    return maker.add(scan);
  }

  void begin(const Observation& observation) {
    is_begun = true;
    has_odometry = observation.has_odometry;
    Pose2 start = observation.odom_from_robot;
    if (newest) {
      const Pose2 step = newest->odom_from_robot && has_odometry
                             ? between(*newest->odom_from_robot, observation.odom_from_robot)
                             : Pose2();
      start = newest->map_from_robot * step;
      if (has_odometry) run_from_odom = start * inverse(observation.odom_from_robot);
    }
    tracker.emplace(config.tracking, config.resolution_m, observation.run, start);
  }

  /// Where odometry alone has the robot. Without it the robot is taken to stand, and the first that
  /// comes goes on from there.
  [[nodiscard]] Pose2 by_odometry(const Observation& observation) {
    if (!observation.has_odometry) return newest ? newest->map_from_robot : Pose2();
    const Pose2& odom = observation.odom_from_robot;
    if (!has_odometry && newest) run_from_odom = newest->map_from_robot * inverse(odom);
    has_odometry = true;
    return run_from_odom ? *run_from_odom * odom : odom;
  }
};

TopologyMapper::TopologyMapper(const TopologyMapperConfig& config, std::uint64_t seed, int threads,
                               const PathKeepConfig& keep) {
  require_valid(config, "topology mapping");
  require_valid(keep, "topology mapping: keep");
  state_ = std::make_unique<State>(config, seed, threads, keep);
}

TopologyMapper::~TopologyMapper() = default;

std::vector<MadeVisit> TopologyMapper::add(const Observation& observation, const Pose2* given) {
  State& s = *state_;
  const bool follows = s.scans.empty() || (observation.run == s.scans.back().run &&
                                           s.newest->stamp < observation.scan.stamp);
  if (!follows || s.is_full() ||
      (observation.has_odometry && !is_finite(observation.odom_from_robot)) ||
      (given != nullptr && !is_finite(*given))) {
    ++s.skipped;
    return {};
  }
  if (!s.is_begun) s.begin(observation);
  PosedScan scan{observation.run, observation.scan, s.by_odometry(observation), {}};
  if (given != nullptr) {
    scan.map_from_robot = *given;
  } else if (s.config.match_scans) {
    const Pose2* odometry = observation.has_odometry ? &observation.odom_from_robot : nullptr;
    scan.map_from_robot = s.tracker->add(observation.scan, odometry, s.tracked).run_from_robot.mean;
    (void)s.tracker->take_finished();
  }
  ++s.tracked;
  s.newest = {scan.scan.stamp, scan.map_from_robot,
              observation.has_odometry ? std::optional(observation.odom_from_robot) : std::nullopt};
  if (s.is_beside_last(scan.map_from_robot)) return {};
  return s.keep_scan(scan);
}

std::vector<MadeVisit> TopologyMapper::restore(const PosedScan& tracked) {
  ++state_->tracked;
  state_->newest = {tracked.scan.stamp, tracked.map_from_robot, std::nullopt};
  // Older versions wrote those of a standing robot, too.
  if (state_->is_beside_last(tracked.map_from_robot)) return {};
  return state_->keep_scan(tracked);
}

void TopologyMapper::resume_from(const TrackedMoment& newest) { state_->newest = newest; }

bool TopologyMapper::mark(Stamp stamp) { return !state_->is_full() && state_->maker.mark(stamp); }

std::vector<MadeVisit> TopologyMapper::finish() { return state_->maker.finish(); }

bool TopologyMapper::update(MadeVisit visit) {
  if (!state_->filter.add(visit.visit)) return false;
  state_->visits.push_back(std::move(visit));
  state_->names.update(state_->filter.posterior().front().labels);
  return true;
}

const TopologyMapperConfig& TopologyMapper::config() const { return state_->config; }
int TopologyMapper::threads() const { return state_->threads; }
const TopologyFilter& TopologyMapper::filter() const { return state_->filter; }
const std::vector<MadeVisit>& TopologyMapper::visits() const { return state_->visits; }
const std::vector<int>& TopologyMapper::place_names() const { return state_->names.names(); }
const std::vector<PosedScan>& TopologyMapper::scans() const { return state_->scans; }
const std::optional<TrackedMoment>& TopologyMapper::newest() const { return state_->newest; }
std::size_t TopologyMapper::tracked_scans() const { return state_->tracked; }
std::size_t TopologyMapper::skipped_scans() const { return state_->skipped; }
bool TopologyMapper::is_full() const { return state_->is_full(); }

TopologyCounts TopologyMapper::counts() const {
  TopologyCounts counts = state_->filter.counts();
  counts.late_visits += state_->maker.late();
  return counts;
}

}  // namespace strata::topology
