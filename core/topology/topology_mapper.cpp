// SPDX-License-Identifier: Apache-2.0
#include "core/topology/topology_mapper.hpp"

#include <optional>
#include <utility>

#include "core/slam/tracker.hpp"

namespace strata::topology {

struct TopologyMapper::State {
  State(const TopologyMapperConfig& mapper_config, std::uint64_t seed, int thread_count)
      : config(mapper_config),
        maker(mapper_config.landmarks),
        filter(mapper_config.topology, seed, thread_count),
        threads(thread_count) {}

  TopologyMapperConfig config;
  std::optional<slam::Tracker> tracker;
  VisitMaker maker;
  TopologyFilter filter;
  int threads = 1;
  std::vector<PosedScan> scans;
  std::vector<MadeVisit> visits;
  std::size_t skipped = 0;
  bool is_begun = false;  // a scan came that was not restored
  std::optional<Pose2> resumed_odom;
  std::optional<Pose2> run_from_odom;  // nothing: the same, unless the mapper was restored

  void begin(const Observation& observation) {
    is_begun = true;
    Pose2 start = observation.odom_from_robot;
    if (!scans.empty()) {
      const Pose2 step =
          resumed_odom ? between(*resumed_odom, observation.odom_from_robot) : Pose2();
      start = scans.back().map_from_robot * step;
      run_from_odom = start * inverse(observation.odom_from_robot);
    }
    tracker.emplace(config.tracking, config.resolution_m, observation.run, start);
  }
};

TopologyMapper::TopologyMapper(const TopologyMapperConfig& config, std::uint64_t seed,
                               int threads) {
  require_valid(config, "topology mapping");
  state_ = std::make_unique<State>(config, seed, threads);
}

TopologyMapper::~TopologyMapper() = default;

std::vector<MadeVisit> TopologyMapper::add(const Observation& observation, const Pose2* given) {
  State& s = *state_;
  const bool follows = s.scans.empty() || (observation.run == s.scans.back().run &&
                                           s.scans.back().scan.stamp < observation.scan.stamp);
  if (!follows || (observation.has_odometry && !is_finite(observation.odom_from_robot)) ||
      (given != nullptr && !is_finite(*given))) {
    ++s.skipped;
    return {};
  }
  if (!s.is_begun) s.begin(observation);
  PosedScan scan{observation.run, observation.scan, observation.odom_from_robot, {}};
  if (s.run_from_odom) scan.map_from_robot = *s.run_from_odom * observation.odom_from_robot;
  if (given != nullptr) {
    scan.map_from_robot = *given;
  } else if (s.config.match_scans) {
    const Pose2* odometry = observation.has_odometry ? &observation.odom_from_robot : nullptr;
    scan.map_from_robot =
        s.tracker->add(observation.scan, odometry, s.scans.size()).run_from_robot.mean;
    (void)s.tracker->take_finished();
  }
  s.scans.push_back(scan);
  return s.maker.add(scan);
}

std::vector<MadeVisit> TopologyMapper::restore(const PosedScan& tracked) {
  state_->scans.push_back(tracked);
  return state_->maker.add(tracked);
}

void TopologyMapper::resume_from(const Pose2& odom_from_robot) {
  state_->resumed_odom = odom_from_robot;
}

void TopologyMapper::mark(Stamp stamp) { state_->maker.mark(stamp); }

std::vector<MadeVisit> TopologyMapper::finish() { return state_->maker.finish(); }

bool TopologyMapper::update(MadeVisit visit) {
  if (!state_->filter.add(visit.visit)) return false;
  state_->visits.push_back(std::move(visit));
  return true;
}

const TopologyMapperConfig& TopologyMapper::config() const { return state_->config; }
int TopologyMapper::threads() const { return state_->threads; }
const TopologyFilter& TopologyMapper::filter() const { return state_->filter; }
const std::vector<MadeVisit>& TopologyMapper::visits() const { return state_->visits; }
const std::vector<PosedScan>& TopologyMapper::scans() const { return state_->scans; }
std::size_t TopologyMapper::skipped_scans() const { return state_->skipped; }

TopologyCounts TopologyMapper::counts() const {
  TopologyCounts counts = state_->filter.counts();
  counts.late_visits += state_->maker.late();
  return counts;
}

}  // namespace strata::topology
