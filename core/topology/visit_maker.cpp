// SPDX-License-Identifier: Apache-2.0
#include "core/topology/visit_maker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace strata::topology {
namespace {

/// Scans this near to the one before are left out of local clouds.
constexpr double kSubsampleM = 0.05;
/// Way that is remembered behind the robot.
constexpr double kMemoryM = 40.0;
/// Way of the robot between two landmarks that are given: nearer ones are one. Each visit costs
/// more than the one before, so that who says "here" all the time must not make one of each scan.
constexpr double kLeastWayM = 0.5;
/// Given landmarks that wait for their moment; who names more does not know the time.
constexpr std::size_t kMaxWaiting = 10'000;

}  // namespace

std::vector<MadeVisit> VisitMaker::add(const PosedScan& scan) {
  if (!passed_.empty()) {
    const PosedScan& last = passed_.back().scan;
    if (scan.scan.stamp <= last.scan.stamp) return {};
    path_length_m_ += translation_distance(last.map_from_robot, scan.map_from_robot);
    // The newest scan is always kept; the one before only if it is away from its predecessor.
    const std::size_t n = passed_.size();
    if (n >= 2 && passed_[n - 1].path_length_m - passed_[n - 2].path_length_m < kSubsampleM) {
      passed_.pop_back();
    }
  }
  passed_.push_back({scan, path_length_m_});
  if (config_.source == LandmarkSource::kDetected) {
    for (const LandmarkEvent& event : detector_.add(scan)) {
      wait_for({event.stamp, event.center_m});
    }
  }
  std::vector<MadeVisit> visits = make(false);
  forget_far_scans();
  return visits;
}

bool VisitMaker::mark(Stamp stamp) {
  if (waiting_.size() >= kMaxWaiting || (last_visit_ && stamp <= *last_visit_)) {
    ++late_;
    return false;
  }
  wait_for({stamp, std::nullopt});
  return true;
}

void VisitMaker::wait_for(const Place& place) {
  const auto after =
      std::upper_bound(waiting_.begin(), waiting_.end(), place,
                       [](const Place& a, const Place& b) { return a.stamp < b.stamp; });
  waiting_.insert(after, place);
}

std::vector<MadeVisit> VisitMaker::finish() {
  if (config_.source == LandmarkSource::kDetected) {
    for (const LandmarkEvent& event : detector_.finish()) {
      wait_for({event.stamp, event.center_m});
    }
  }
  return make(true);
}

std::size_t VisitMaker::nearest(Stamp stamp) const {
  std::size_t best = 0;
  for (std::size_t i = 1; i < passed_.size(); ++i) {
    const auto off = [&](std::size_t k) {
      return std::abs((passed_[k].scan.scan.stamp - stamp).seconds());
    };
    if (off(i) < off(best)) best = i;
  }
  return best;
}

std::vector<MadeVisit> VisitMaker::make(bool all) {
  std::vector<MadeVisit> visits;
  if (passed_.empty()) return visits;
  while (!waiting_.empty()) {
    const Place place = waiting_.front();
    if (!all && passed_.back().scan.scan.stamp < place.stamp) break;
    const Passed& at = passed_[nearest(place.stamp)];
    if (!all && path_length_m_ - at.path_length_m < config_.cloud.path_radius_m) break;
    waiting_.erase(waiting_.begin());
    // The filter takes visits in order of time only.
    const bool is_repeated = !place.center_m && last_visit_path_length_m_ &&
                             at.path_length_m - *last_visit_path_length_m_ < kLeastWayM;
    if (is_repeated || (last_visit_ && at.scan.scan.stamp <= *last_visit_)) {
      ++late_;
      continue;
    }
    Pose2 pose = at.scan.map_from_robot;
    if (place.center_m) pose = {place.center_m->x(), place.center_m->y(), pose.theta};
    std::vector<PosedScan> around;
    for (const Passed& passed : passed_) {
      if (std::abs(passed.path_length_m - at.path_length_m) > 2.0 * config_.cloud.path_radius_m) {
        continue;
      }
      around.push_back(passed.scan);
    }
    MadeVisit made;
    made.visit.stamp = at.scan.scan.stamp;
    made.visit.odom_from_robot = pose;
    made.visit.path_length_m =
        last_visit_path_length_m_ ? at.path_length_m - *last_visit_path_length_m_ : 0.0;
    made.visit.cloud = make_local_cloud(around, pose, config_.cloud);
    made.robot_from_visit = between(at.scan.map_from_robot, pose);
    last_visit_ = made.visit.stamp;
    last_visit_path_length_m_ = at.path_length_m;
    visits.push_back(std::move(made));
  }
  return visits;
}

void VisitMaker::forget_far_scans() {
  const auto keep = std::find_if(passed_.begin(), passed_.end(), [&](const Passed& passed) {
    return path_length_m_ - passed.path_length_m <= kMemoryM;
  });
  if (keep - passed_.begin() < 200) return;  // seldom, since it moves all others
  passed_.erase(passed_.begin(), keep);
}

}  // namespace strata::topology
