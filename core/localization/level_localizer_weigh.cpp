// SPDX-License-Identifier: Apache-2.0
// What a scan is worth on each level, and what follows from that.
#include <algorithm>
#include <cmath>

#include "core/geometry/angle.hpp"
#include "core/localization/level_localizer.hpp"
#include "core/rays/scan_beams.hpp"

namespace strata::localization {
namespace {

/// Scans nearer to each other than this tell the same of the level.
constexpr double kWeighedEvery_s = 0.08;
/// After a pause the next scan counts no more than others.
constexpr double kMaxElapsed_s = 0.25;
/// The pose of a level that a robot came to.
constexpr double kArrivedStddev_m = 0.1;
constexpr double kArrivedStddev_rad = 0.05;
/// Places that a search still follows on a level, of which so many are looked at.
constexpr std::size_t kMaxPlaces = 8;
/// Poses nearer than this are one to the ranking, whose first steps are as long.
constexpr double kSame_m = 0.05;
constexpr double kSame_rad = 0.02;
/// From this share of the margin on another level makes a level that was believed unsure.
constexpr double kDoubtedShare = 0.5;

bool is_same(const Pose2& a, const Pose2& b) {
  return translation_distance(a, b) < kSame_m &&
         std::abs(wrap_angle(a.theta - b.theta)) < kSame_rad;
}

}  // namespace

/// In a search each level has places of its own; else the robot is at one place, on any level, and
/// what another level has made of it is tried too.
std::vector<PlaceCandidate> LevelLocalizer::candidates_of(const Hypothesis& hypothesis) const {
  std::vector<PlaceCandidate> candidates;
  const auto add = [&](const Pose2& pose) {
    if (std::none_of(candidates.begin(), candidates.end(), [&](const PlaceCandidate& other) {
          return is_same(pose, other.map_from_robot);
        })) {
      candidates.push_back({pose, 0.0});
    }
  };
  add(hypothesis.map_from_robot);
  if (is_search_) {
    const auto& places = hypothesis.filter->result().places;
    for (std::size_t i = 0; i < std::min(places.size(), kMaxPlaces); ++i) {
      add(places[i].map_from_robot);
    }
    return candidates;
  }
  add(result_.pose.mean);
  for (const Hypothesis& other : hypotheses_) add(other.map_from_robot);
  return candidates;
}

/// What the scan is worth on each level.
void LevelLocalizer::weigh(const Observation& observation) {
  const Stamp now = observation.scan.stamp;
  const double elapsed_s = weighed_ ? (now - *weighed_).seconds() : kWeighedEvery_s;
  if (elapsed_s >= 0.0 && elapsed_s < kWeighedEvery_s && weighed_) return;
  if (!rays::says_something(observation.scan)) return;
  const auto seeks = [](const Hypothesis& hypothesis) {
    const LocalizationResult& result = hypothesis.filter->result();
    return result.is_ambiguous && result.places.empty();
  };
  if (is_search_ && std::any_of(hypotheses_.begin(), hypotheses_.end(), seeks)) return;
  weighed_ = now;
  std::vector<double> nats;
  std::vector<Pose2> found;
  for (const Hypothesis& hypothesis : hypotheses_) {
    const RankedPlace best = rank_places(candidates_of(hypothesis), observation.scan,
                                         *levels_[hypothesis.level].sensor, {}, pool_)
                                 .front();
    nats.push_back(best.log_likelihood);
    found.push_back(best.map_from_robot);
  }
  if (!is_search_) {
    for (std::size_t i = 0; i < found.size(); ++i) hypotheses_[i].map_from_robot = found[i];
  }
  const std::size_t before = choice_.leading();
  choice_.weigh(nats, std::min(elapsed_s, kMaxElapsed_s),
                is_search_ ? choice_config_.search_memory_s : choice_config_.memory_s);
  if (choice_.leading() != before) take_leading(observation, before);
}

/// Another level has refuted the one that led.
void LevelLocalizer::take_leading(const Observation& observation, std::size_t before) {
  is_sure_ = false;
  Hypothesis& leading = hypotheses_[choice_.leading()];
  if (leading.filter == nullptr) {
    leading.filter = make_filter(leading.level);
    leading.filter->initialize(
        {leading.map_from_robot, pose_covariance(kArrivedStddev_m, kArrivedStddev_rad)});
    (void)leading.filter->update(observation);
    hypotheses_[before].filter = nullptr;
  }
  result_ = leading.filter->result();
}

/// Whether the level is believed, and the others need not be looked at any more.
void LevelLocalizer::judge() {
  const bool is_decided = choice_.is_decided() && result_.place_score >= choice_config_.min_score;
  if (lift_) {
    is_sure_ = is_decided;  // while a door is closed nothing tells
    return;
  }
  if (is_decided && !result_.is_ambiguous) is_sure_ = true;
  if (choice_.lead_nats() <= -kDoubtedShare * choice_config_.refuted_nats) is_sure_ = false;
  if (!is_sure_ || (!is_search_ && since_lift_m_ < choice_config_.watched_m)) return;
  Hypothesis left = std::move(hypotheses_[choice_.leading()]);
  hypotheses_.clear();
  hypotheses_.push_back(std::move(left));
  choice_.begin(1, 0);
  is_search_ = false;
}

}  // namespace strata::localization
