// SPDX-License-Identifier: Apache-2.0
/// When the filter is wrong: averages of the likelihood, poses to try, and a verdict.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/config.hpp"
#include "core/geometry/pose2.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/localization/inlier_shares.hpp"
#include "core/random/stream.hpp"

namespace strata::localization {

/// Augmented MCL [thrun2005probabilistic, table 8.3] and the thresholds of the verdict.
/// Both ways of recovering are off by default, as in nav2's AMCL: in a building that changed much
/// since it was mapped they give up correct poses. `kidnapping_recovery` turns them on. The search
/// beside the pose (place_watch.hpp) is another matter.
struct RecoveryConfig {
  bool inject = false;
  double slow_rate = 0.001;
  double fast_rate = 0.1;
  double tolerated_drop = 0.2;
  double max_injected = 0.5;
  double lost_share = 0.75;
  double lost_surface_share = 0.8;
  double lost_passing_share = 0.95;
  double outdated_share = 0.9;
  int restart_after = 0;
  double uncertain_stddev_m = 0.5;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("inject", c.inject, {.doc = "try random poses when the likelihood drops"});
    v.field("slow_rate", c.slow_rate,
            {.doc = "rate of the long average per weighed scan", .min = 0.0, .max = 1.0});
    v.field("fast_rate", c.fast_rate,
            {.doc = "rate of the short average per weighed scan", .min = 0.0, .max = 1.0});
    v.field("tolerated_drop", c.tolerated_drop,
            {.doc = "relative drop of the likelihood per beam that injects nothing",
             .min = 0.0,
             .max = 1.0});
    v.renamed("most_injected", "max_injected");
    v.field("max_injected", c.max_injected,
            {.doc = "greatest share of random poses", .min = 0.0, .max = 1.0});
    v.field(
        "lost_share", c.lost_share,
        {.doc = "lost when the short average of the share of beams that end at the first obstacle "
                "on their way, of those that the map can judge, is below this share of the long "
                "one, and the next two hold; what recovers begins when so few are inliers",
         .min = 0.0,
         .max = 1.0});
    v.field("lost_surface_share", c.lost_surface_share,
            {.doc = "... that of beams that end at any surface, whatever lies before it, is below "
                    "this, those that the map cannot judge counting as usual: not where things "
                    "were taken away",
             .min = 0.0,
             .max = 1.0});
    v.field("lost_passing_share", c.lost_passing_share,
            {.doc = "... and, among the beams that nothing new stops, below this: not where things "
                    "were put down, unless they stop three quarters of all beams",
             .min = 0.0,
             .max = 1.0});
    v.field("outdated_share", c.outdated_share,
            {.doc = "map outdated here when the share of inlier beams is below this share of "
                    "the long average, or half of the beams cannot be judged",
             .min = 0.0,
             .max = 1.0});
    v.field("restart_after", c.restart_after,
            {.doc = "weighed scans in a row in doubt until all free space is searched; 0: never",
             .unit = "scans",
             .min = 0});
    v.field("uncertain_stddev_m", c.uncertain_stddev_m,
            {.doc = "above this spread the pose is not converged", .unit = "m", .min = 0.0});
    v.require(c.lost_share <= c.outdated_share, "lost_share", "is above outdated_share",
              "lower it");
    v.require(c.slow_rate < c.fast_rate, "slow_rate", "is not below fast_rate", "lower it");
  }
};

/// For robots that are kidnapped: random poses when the likelihood drops, and a search of all
/// free space after five scans in doubt.
[[nodiscard]] inline RecoveryConfig kidnapping_recovery() {
  RecoveryConfig config;
  config.inject = true;
  config.restart_after = 5;
  return config;
}

/// What the numbers say.
enum class HealthState {
  kGood,
  kConverging,   ///< the particles are spread widely
  kMapOutdated,  ///< a sure pose, but fewer inlier beams than usual, or few judged
  kLost,         ///< far fewer than usual, and no thing taken away or put down explains it
};

/// For saved states (core/base/state_archive.hpp).
[[nodiscard]] constexpr HealthState last_enumerator(HealthState) { return HealthState::kLost; }

/// Inlier shares are of those that the map judges (InlierShares).
struct LocalizationHealth {
  HealthState state = HealthState::kConverging;
  /// Lost, or fewer inlier beams than lost_share of the usual: nothing is learned from there.
  bool is_in_doubt = false;
  double inlier_share = 1.0;         ///< of this scan, at the mean pose; 1 when none is judged
  double inlier_share_fast = 1.0;    ///< short average, each scan weighted by its judged beams
  double inlier_share_slow = 1.0;    ///< long average
  double judged_share_fast = 1.0;    ///< short average of the share of beams that the map judges
  double likelihood_per_beam = 0.0;  ///< of the last weighed scan; 0: none yet
  double likelihood_ratio = 1.0;     ///< short over long average of the likelihood per beam
  double position_stddev_m = 0.0;    ///< sqrt of the trace of the position's covariance
};

/// With fewer than half of the beams judged the map is too little known to call a pose lost in it,
/// or to look for a better one.
inline constexpr double kMinJudged = 0.5;

/// The averages of one run. A first value sets both; early on the long one is the plain mean, so
/// that it does not keep the memory of the first scan for 1 / slow_rate scans.
class HealthMonitor {
 public:
  explicit HealthMonitor(const RecoveryConfig& config) : config_(config) {}

  void reset() { *this = HealthMonitor(config_); }
  /// likelihood_per_beam: geometric mean over beams of the likelihood, averaged over the particles.
  /// score: how sure the pose is besides (pose_score.hpp), if known: no pose that is likelier right
  /// than wrong is called lost.
  void add(double likelihood_per_beam, const InlierShares& shares, double position_stddev_m,
           std::optional<double> score = std::nullopt);
  /// A scan was not weighed, since the map says nothing of most of what it shows: of the beams that
  /// say something it judges that share. What was usual stays, and so does doubt: nothing was seen
  /// that speaks for or against the pose. That few are judged, and the spread, is told.
  void add_unjudged(double judged_share, double position_stddev_m);
  [[nodiscard]] const LocalizationHealth& health() const { return health_; }
  /// Fewer beams than usual are inliers, of late.
  [[nodiscard]] bool is_outdated() const {
    return health_.inlier_share_fast < config_.outdated_share * health_.inlier_share_slow;
  }
  /// Share of particles to replace: max(0, 1 - fast / ((1 - tolerated_drop) slow)).
  [[nodiscard]] double injection_share() const;
  /// Whether the pose has been in doubt for restart_after values in a row: fewer inlier beams
  /// than lost_share of the usual, or lost. That is sooner than the verdict, since looking for a
  /// better place costs less than to call a right one wrong.
  [[nodiscard]] bool wants_restart() const {
    return config_.restart_after > 0 && doubtful_in_a_row_ >= config_.restart_after;
  }
  /// A search has begun, of this many values at most: no other one while they are all in doubt.
  void search_begins(int updates) { doubtful_in_a_row_ = -updates; }
  [[nodiscard]] bool is_searching() const { return doubtful_in_a_row_ < 0; }
  /// The search has found a place before that. While that is still in doubt, 1 / fast_rate values
  /// go by without injection, in which the short averages forget most of what was before it.
  void search_ends();

  /// For saved states; the config is the constructor's.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    auto& health = self.health_;
    archive(health.state);
    archive(health.is_in_doubt);
    for (auto* value :
         {&health.inlier_share, &health.inlier_share_fast, &health.inlier_share_slow,
          &health.judged_share_fast, &health.likelihood_per_beam, &health.likelihood_ratio,
          &health.position_stddev_m, &self.likelihood_fast_, &self.likelihood_slow_}) {
      archive(*value);
    }
    archive(self.count_);
    archive(self.doubtful_in_a_row_);
    archive(self.fast_);
    archive(self.slow_);
  }

 private:
  [[nodiscard]] bool is_contradicted() const;

  RecoveryConfig config_;
  LocalizationHealth health_;
  std::size_t count_ = 0;
  int doubtful_in_a_row_ = 0;
  InlierShares fast_;
  InlierShares slow_;
  double likelihood_fast_ = 0.0;
  double likelihood_slow_ = 0.0;
};

/// Poses drawn uniformly from the free cells of a map.
class FreeSpace {
 public:
  FreeSpace() = default;
  explicit FreeSpace(const ReflectionGrid& map);

  [[nodiscard]] bool empty() const { return cells_.empty(); }
  [[nodiscard]] double area_m2() const {
    return static_cast<double>(cells_.size()) * resolution_m_ * resolution_m_;
  }
  /// Requires !empty().
  [[nodiscard]] Pose2 draw(RandomStream& random) const;

 private:
  double resolution_m_ = 0.05;
  std::vector<Cell> cells_;
};

}  // namespace strata::localization

template <>
struct strata::EnumNames<strata::localization::HealthState> {
  static constexpr std::array<std::pair<strata::localization::HealthState, const char*>, 4> values{
      {{strata::localization::HealthState::kGood, "good"},
       {strata::localization::HealthState::kConverging, "converging"},
       {strata::localization::HealthState::kMapOutdated, "map_outdated"},
       {strata::localization::HealthState::kLost, "lost"}}};
};
