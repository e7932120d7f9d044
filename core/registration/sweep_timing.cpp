// SPDX-License-Identifier: Apache-2.0
#include "core/registration/sweep_timing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <Eigen/Geometry>

#include "core/geometry/angle.hpp"
#include "core/registration/match_field.hpp"
#include "core/registration/scan_matcher.hpp"
#include "core/scan/endpoints.hpp"

namespace strata::registration {
namespace {

constexpr std::size_t kMaxPairs = 24;
constexpr std::size_t kMinPairs = 8;
constexpr double kMinTurnRad = 0.03;
constexpr double kLongestGapS = 1.0;
constexpr int kDelaysPerSweep = 4;
/// Delays that are tried, in quarters of a sweep.
constexpr int kMinStep = -kDelaysPerSweep;
constexpr int kMaxStep = 2 * kDelaysPerSweep;
constexpr double kMinGain = 0.1;
constexpr std::size_t kMaxBeams = 180;
/// Odometry between two consecutive scans is good to this.
constexpr double kOdometryStddevM = 0.02;
constexpr double kOdometryStddevRad = 0.01;

struct Pair {
  std::size_t first = 0;
  double signal_rad = 0.0;
};

/// Whether odometry is there under every timing that is tried: a pair that costs nothing under one
/// of them would speak for it.
bool has_odometry_throughout(const Scan& scan, const OdometryAt& odometry,
                             const SweepTiming& stated_timing) {
  const Duration sweep = sweep_duration(scan);
  const Duration stated = Duration::from_seconds(stated_timing.delay_s);
  for (int step = kMinStep - kDelaysPerSweep; step <= kMaxStep; ++step) {
    const Duration delay = Duration::from_seconds(sweep.seconds() * step / kDelaysPerSweep);
    if (!odometry(scan.stamp - delay)) return false;
  }
  return odometry(scan.stamp - stated) && odometry(scan.stamp - stated + sweep);
}

/// Pairs of consecutive scans that say most: turning distorts, changes of turning tell the delay.
std::vector<Pair> turning_pairs(std::span<const Scan> scans, const OdometryAt& odometry,
                                const SweepTiming& stated_timing) {
  std::vector<Pair> pairs;
  double last_turn = 0.0;
  for (std::size_t i = 0; i + 1 < scans.size(); ++i) {
    const double gap_s = (scans[i + 1].stamp - scans[i].stamp).seconds();
    const auto here = odometry(scans[i].stamp);
    const auto next = odometry(scans[i + 1].stamp);
    if (!here || !next || gap_s <= 0.0 || gap_s > kLongestGapS) continue;
    const double turn = angle_difference(next->theta, here->theta);
    const double signal = std::abs(turn) + std::abs(turn - last_turn);
    last_turn = turn;
    if (std::abs(turn) < kMinTurnRad) continue;
    if (!has_odometry_throughout(scans[i], odometry, stated_timing)) continue;
    if (!has_odometry_throughout(scans[i + 1], odometry, stated_timing)) continue;
    pairs.push_back({i, signal});
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.signal_rad > b.signal_rad; });
  if (pairs.size() > kMaxPairs) pairs.resize(kMaxPairs);
  return pairs;
}

struct Placed {
  Scan scan;
  Pose2 odom_from_robot;
};

std::optional<Placed> placed(const Scan& scan, const OdometryAt& odometry,
                             const SweepTiming& timing) {
  const Stamp start = scan.stamp - Duration::from_seconds(timing.delay_s);
  const auto here = odometry(start);
  const auto end = odometry(start + sweep_duration(scan));
  if (!here || !end) return std::nullopt;
  return Placed{undistort(scan, between(*here, *end), timing.reversed), *here};
}

MatchField field_of(const Scan& scan) {
  MatchField field(0.05, {.radius_m = 0.4});
  const Endpoints endpoints = endpoints_in_robot(scan);
  std::vector<SweepSurface> surfaces;
  surfaces_in_sweep(endpoints, std::abs(static_cast<double>(scan.angle_increment_rad)), surfaces);
  Eigen::AlignedBox2d box;
  for (std::size_t i = 0; i < endpoints.size(); ++i) {
    box.extend(Eigen::Vector2d(endpoints.x_m[i], endpoints.y_m[i]));
  }
  if (!box.isEmpty()) field.reserve(box.min(), box.max());
  for (std::size_t i = 0; i < endpoints.size(); ++i) {
    SurfacePoint point;
    point.x_m = endpoints.x_m[i];
    point.y_m = endpoints.y_m[i];
    set_surface_direction(point, surfaces[i].normal);
    field.add(point);
  }
  return field;
}

/// Cost of matching each pair under a timing [nats]. Stops once the sum is above `limit`: no cost
/// is negative, so the rest cannot bring it down.
std::vector<double> costs_of(std::span<const Scan> scans, const std::vector<Pair>& pairs,
                             const OdometryAt& odometry, const SweepTiming& timing,
                             double limit = std::numeric_limits<double>::infinity()) {
  std::vector<double> costs;
  double sum = 0.0;
  for (const Pair& pair : pairs) {
    if (sum > limit) break;
    costs.push_back(0.0);
    const auto first = placed(scans[pair.first], odometry, timing);
    const auto second = placed(scans[pair.first + 1], odometry, timing);
    if (!first || !second) continue;
    const Pose2Gaussian prior{between(first->odom_from_robot, second->odom_from_robot),
                              pose_covariance(kOdometryStddevM, kOdometryStddevRad)};
    const MatchResult result = match(subsample(endpoints_in_robot(second->scan), kMaxBeams), {},
                                     field_of(first->scan), prior.mean, &prior);
    costs.back() = result.cost;
    sum += result.cost;
  }
  return costs;
}

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Where the parabola through three equidistant values has its least, in steps from the middle.
double lowest_of_three(double before, double middle, double after) {
  const double bend = before - 2.0 * middle + after;
  return bend > 0.0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
}

/// The timings tried, and the best of them: delays in quarters of a sweep, for both orders of
/// beams.
class TimingSearch {
 public:
  TimingSearch(std::span<const Scan> scans, const std::vector<Pair>& pairs,
               const OdometryAt& odometry, double sweep_s, const SweepTiming& stated_timing,
               std::vector<double> stated_costs)
      : scans_(scans),
        pairs_(pairs),
        odometry_(odometry),
        sweep_s_(sweep_s),
        best_(std::move(stated_costs)) {
    if (stated_timing.delay_s == 0.0) {
      lowest_[stated_timing.reversed ? 1 : 0] = {stated_timing.reversed, 0, sum_of(best_)};
    }
  }

  /// Whole sweeps in both orders, then halves and quarters about the best of each order: the cost
  /// has one valley about a sweep wide. The better order goes first and lets the other stop early.
  void run() {
    for (const bool reversed : {false, true}) {
      for (int step = kMinStep; step <= kMaxStep; step += kDelaysPerSweep) {
        const Step& lowest = lowest_[reversed ? 1 : 0];
        const bool is_known = step == 0 && lowest.step == 0 && std::isfinite(lowest.cost);
        if (!is_known) attempt(reversed, step, lowest.cost);
      }
    }
    const bool first = lowest_[1].cost < lowest_[0].cost;
    for (const bool reversed : {first, !first}) {
      for (int width = kDelaysPerSweep / 2; width > 0; width /= 2) {
        const int middle = lowest_[reversed ? 1 : 0].step;
        attempt(reversed, middle - width, sum_of(best_));
        attempt(reversed, middle + width, sum_of(best_));
      }
    }
  }

  [[nodiscard]] const std::vector<double>& best() const { return best_; }

  /// The best timing with its delay between the steps; nothing when no step beats what is stated.
  [[nodiscard]] std::optional<SweepTiming> timing() const {
    if (!improved_) return std::nullopt;
    SweepTiming timing = candidate(found_.reversed, found_.step);
    if (found_.step > kMinStep && found_.step < kMaxStep) {
      const auto beside = [&](int step) {
        return sum_of(costs_of(scans_, pairs_, odometry_, candidate(timing.reversed, step)));
      };
      timing.delay_s +=
          sweep_s_ / kDelaysPerSweep *
          lowest_of_three(beside(found_.step - 1), sum_of(best_), beside(found_.step + 1));
    }
    return timing;
  }

 private:
  struct Step {
    bool reversed = false;
    int step = 0;
    double cost = std::numeric_limits<double>::infinity();
  };

  [[nodiscard]] SweepTiming candidate(bool reversed, int step) const {
    return {reversed, sweep_s_ * step / kDelaysPerSweep};
  }

  void attempt(bool reversed, int step, double limit) {
    if (step < kMinStep || step > kMaxStep) return;
    std::vector<double> costs =
        costs_of(scans_, pairs_, odometry_, candidate(reversed, step), limit);
    const double cost = sum_of(costs);
    if (cost >= limit) return;
    lowest_[reversed ? 1 : 0] = {reversed, step, cost};
    if (cost >= sum_of(best_)) return;
    best_ = std::move(costs);
    found_ = lowest_[reversed ? 1 : 0];
    improved_ = true;
  }

  std::span<const Scan> scans_;
  const std::vector<Pair>& pairs_;
  const OdometryAt& odometry_;
  double sweep_s_;
  std::vector<double> best_;
  Step found_;  ///< the step of `best_`, when any was better than what is stated
  bool improved_ = false;
  std::array<Step, 2> lowest_;
};

}  // namespace

SweepTimingEstimate estimate_sweep_timing(std::span<const Scan> scans, const OdometryAt& odometry,
                                          const SweepTiming& stated_timing) {
  SweepTimingEstimate result;
  result.timing = stated_timing;
  if (scans.empty()) return result;
  const double sweep_s = sweep_duration(scans[scans.size() / 2]).seconds();
  if (sweep_s <= 0.0) return result;
  const std::vector<Pair> pairs = turning_pairs(scans, odometry, stated_timing);
  result.pairs = pairs.size();
  if (pairs.size() < kMinPairs) return result;

  const auto count = static_cast<double>(pairs.size());
  const std::vector<double> stated = costs_of(scans, pairs, odometry, stated_timing);
  TimingSearch search(scans, pairs, odometry, sweep_s, stated_timing, stated);
  search.run();
  const std::vector<double>& best = search.best();
  result.stated_cost = sum_of(stated) / count;
  result.estimate_cost = sum_of(best) / count;
  std::size_t better = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) better += best[i] < stated[i] ? 1 : 0;
  result.certain = result.estimate_cost < (1.0 - kMinGain) * result.stated_cost &&
                   4 * better >= 3 * pairs.size();
  if (result.certain) result.timing = search.timing().value_or(stated_timing);
  return result;
}

}  // namespace strata::registration
