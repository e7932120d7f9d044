// SPDX-License-Identifier: Apache-2.0
#include "core/localization/level_localizer.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/base/error.hpp"

namespace strata::localization {

LevelLocalizer::LevelLocalizer(const LocalizerConfig& config, const LevelChoiceConfig& choice,
                               std::vector<LevelMaps> levels, std::uint64_t seed, int threads)
    : config_(config),
      choice_config_(choice),
      levels_(std::move(levels)),
      seed_(seed),
      threads_(threads),
      pool_(threads),
      choice_(choice) {
  require_valid(choice, "levels");
  for (std::size_t i = 0; i < levels_.size() && hypotheses_.empty(); ++i) {
    if (levels_[i].sensor != nullptr) hypotheses_.push_back({i, {}, make_filter(i)});
  }
  if (hypotheses_.empty()) throw std::invalid_argument("LevelLocalizer: no level has maps");
  choice_.begin(1, 0);
}

void LevelLocalizer::require_maps(std::size_t level) const {
  if (level < levels_.size() && levels_[level].sensor != nullptr) return;
  throw InputError("level", "has no maps", "activate a version of it");
}

std::shared_ptr<Localizer> LevelLocalizer::make_filter(std::size_t level) const {
  auto filter = std::make_shared<Localizer>(config_, levels_[level].sensor, seed_, threads_);
  filter->set_free_space(*levels_[level].map);
  return filter;
}

void LevelLocalizer::set_maps(std::size_t level, LevelMaps maps) {
  levels_.at(level) = std::move(maps);
  for (const Hypothesis& hypothesis : hypotheses_) {
    if (hypothesis.level != level || hypothesis.filter == nullptr) continue;
    hypothesis.filter->set_model(levels_[level].sensor);
    hypothesis.filter->set_free_space(*levels_[level].map);
  }
}

void LevelLocalizer::begin(std::vector<Hypothesis> hypotheses, bool is_search, bool is_sure) {
  hypotheses_ = std::move(hypotheses);
  is_search_ = is_search;
  is_sure_ = is_sure;
  choice_.begin(hypotheses_.size(), is_sure ? std::optional<std::size_t>(0) : std::nullopt);
  lift_.reset();
  since_lift_m_ = 0.0;
  last_.reset();
  weighed_.reset();
}

void LevelLocalizer::initialize(const Pose2Gaussian& map_from_robot,
                                std::optional<std::size_t> level) {
  std::vector<Hypothesis> possible;
  if (level) require_maps(*level);
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    if (level ? i != *level : levels_[i].sensor == nullptr) continue;
    possible.push_back({i, map_from_robot.mean, nullptr});
    if (possible.size() > 1) continue;
    possible.front().filter = make_filter(i);
    possible.front().filter->initialize(map_from_robot);
  }
  const bool is_sure = possible.size() == 1;
  begin(std::move(possible), false, is_sure);
}

void LevelLocalizer::initialize_global(std::optional<std::size_t> level) {
  std::vector<Hypothesis> possible;
  if (level) require_maps(*level);
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    if (level ? i != *level : levels_[i].sensor == nullptr) continue;
    possible.push_back({i, {}, make_filter(i)});
    possible.back().filter->initialize_global();
  }
  const bool is_sure = possible.size() == 1;
  begin(std::move(possible), !is_sure, is_sure);
}

void LevelLocalizer::doubt_level() {
  is_sure_ = false;
  choice_.begin(hypotheses_.size(), std::nullopt);
}

void LevelLocalizer::tell_level(std::size_t level) {
  require_maps(level);
  Pose2Gaussian pose = result_.pose;
  if (!last_) {  // nothing was seen yet
    for (Hypothesis& hypothesis : hypotheses_) {
      if (hypothesis.level == level && hypothesis.filter != nullptr) {
        return begin({hypothesis}, false, true);
      }
    }
    pose.mean = hypotheses_.front().map_from_robot;
  }
  for (const Hypothesis& hypothesis : hypotheses_) {
    if (hypothesis.level != level) continue;
    if (hypothesis.filter != nullptr) return begin({hypothesis}, false, true);
    pose.mean = hypothesis.map_from_robot;
  }
  initialize(pose, level);
}

const std::shared_ptr<Localizer>& LevelLocalizer::filter() const {
  return hypotheses_[choice_.leading()].filter;
}

/// Filters see the scan; poses without one go by odometry.
void LevelLocalizer::follow(const Observation& observation) {
  Pose2 motion;
  if (last_ && last_->run == observation.run && last_->has_odometry && observation.has_odometry) {
    motion = between(last_->odom_from_robot, observation.odom_from_robot);
  }
  if (!lift_) since_lift_m_ += motion.translation().norm();
  for (Hypothesis& hypothesis : hypotheses_) {
    hypothesis.map_from_robot = hypothesis.map_from_robot * motion;
    if (hypothesis.filter == nullptr) continue;
    const LocalizationResult& found = hypothesis.filter->update(observation);
    if (is_search_) hypothesis.map_from_robot = found.pose.mean;
    if (hypothesis.filter == filter()) result_ = found;
  }
  if (!last_) last_.emplace();
  last_->run = observation.run;
  last_->odom_from_robot = observation.odom_from_robot;
  last_->has_odometry = observation.has_odometry;
}

/// The levels of a lift become possible when the robot stands in it.
void LevelLocalizer::look_for_lift() {
  lift_.reset();
  if (is_search_ || result_.is_ambiguous) return;
  const Eigen::Vector2d at = result_.pose.mean.translation();
  for (std::size_t i = 0; i < lifts_.size() && !lift_; ++i) {
    const auto& shape = lifts_[i].shape;
    if (std::any_of(shape.begin(), shape.end(),
                    [&](const MetricPolygon& polygon) { return contains(polygon, at); })) {
      lift_ = i;
    }
  }
  if (!lift_) return;
  since_lift_m_ = 0.0;
  const Pose2 pose = hypotheses_[choice_.leading()].map_from_robot;
  for (const std::size_t level : lifts_[*lift_].levels) {
    const bool is_there =
        std::any_of(hypotheses_.begin(), hypotheses_.end(),
                    [&](const Hypothesis& hypothesis) { return hypothesis.level == level; });
    if (is_there || level >= levels_.size() || levels_[level].sensor == nullptr) continue;
    hypotheses_.push_back({level, pose, nullptr});
    choice_.add_level();
  }
}

void LevelLocalizer::make_result() {
  if (is_sure_ || lift_) return;
  result_.is_ambiguous = true;
  result_.converged = false;
  if (result_.health.state == HealthState::kGood) {
    result_.health.state = HealthState::kConverging;
  }
  result_.places.clear();
  for (const LevelBelief& belief : beliefs()) {
    for (const Hypothesis& hypothesis : hypotheses_) {
      if (hypothesis.level != belief.level) continue;
      result_.places.push_back({hypothesis.map_from_robot, belief.probability});
    }
  }
}

const LocalizationResult& LevelLocalizer::update(const Observation& observation) {
  follow(observation);
  look_for_lift();
  if (hypotheses_.size() > 1) {
    weigh(observation);
    judge();
  }
  make_result();
  return result_;
}

std::vector<LevelBelief> LevelLocalizer::beliefs() const {
  const std::vector<double> shares = choice_.probabilities();
  std::vector<LevelBelief> beliefs;
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    beliefs.push_back({hypotheses_[i].level, shares[i]});
  }
  std::stable_sort(beliefs.begin(), beliefs.end(), [](const LevelBelief& a, const LevelBelief& b) {
    return a.probability > b.probability;
  });
  return beliefs;
}

}  // namespace strata::localization
