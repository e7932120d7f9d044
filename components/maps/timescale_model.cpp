// SPDX-License-Identifier: Apache-2.0
#include "components/maps/timescale_model.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "core/base/log_sum.hpp"

namespace strata::maps {
namespace {

using memory::NodeMap;
using memory::NodeOutline;
using rays::BeamMixture;
using rays::ScanBeams;

constexpr double kUnknown_m = std::numeric_limits<double>::infinity();
/// Nodes and grid differ by no more than this about one surface.
constexpr double kAgreement_m = 0.3;

}  // namespace

void TimescaleModel::BelievedLevels::add(const Believed& level) {
  std::size_t place = size_;
  while (place > 0 && levels_[place - 1].weight < level.weight) --place;
  if (place == kMax) return;
  size_ = std::min(size_ + 1, kMax);
  std::move_backward(levels_.begin() + static_cast<std::ptrdiff_t>(place),
                     levels_.begin() + static_cast<std::ptrdiff_t>(size_) - 1,
                     levels_.begin() + static_cast<std::ptrdiff_t>(size_));
  levels_[place] = level;
}

TimescaleModel::TimescaleModel(std::shared_ptr<const memory::TimescaleMemory> memory,
                               std::shared_ptr<const NodeMap> map,
                               const localization::BeamModelConfig& config, const TimescaleUse& use,
                               std::shared_ptr<const rays::RayCaster> base)
    : memory_(std::move(memory)),
      map_(std::move(map)),
      first_map_(map_),
      base_(std::move(base)),
      config_(config),
      beam_mixture_(config.mixture, 1.0),
      use_(use),
      mixture_(use.mixture, map_->level_names().size()) {
  require_valid(config, "beam_model");
}

TimescaleModel::BelievedLevels TimescaleModel::believed() const {
  BelievedLevels levels;
  if (use_.level) {
    levels.add({*use_.level, 1.0});
    return levels;
  }
  int level = 0;
  for (const double weight : mixture_.weights(node_)) {
    if (weight >= use_.min_weight) levels.add({level, weight});
    ++level;
  }
  return levels;
}

double TimescaleModel::beyond_m(const Eigen::Vector2d& laser_m, const Eigen::Vector2d& direction,
                                double free_m, double base_m, double r_max_m) const {
  if (base_m >= free_m - kAgreement_m) return std::max(base_m, free_m);
  // What the base map has before that, the nodes have seen through.
  const Eigen::Vector2d from_m = laser_m + free_m * direction;
  return free_m +
         base_->range_m(from_m.x(), from_m.y(), direction.x(), direction.y(), r_max_m - free_m);
}

void TimescaleModel::cast_in_base(const Pose2& laser, const Scratch& scratch, Beams& beams) const {
  std::array<std::int32_t, kBlock> cells;
  rays::BeamBundle bundle;
  bundle.x_m = laser.x;
  bundle.y_m = laser.y;
  bundle.heading_cosine = std::cos(laser.theta);
  bundle.heading_sine = std::sin(laser.theta);
  bundle.cosine = scratch.beams.cosine.data() + beams.begin;
  bundle.sine = scratch.beams.sine.data() + beams.begin;
  bundle.count = beams.count;
  bundle.max_range_m = scratch.beams.r_max_m;
  base_->expected_ranges_m(bundle, beams.base_m.data(), cells.data());
  beams.is_cast = true;
}

void TimescaleModel::weigh(const Pose2& laser, const NodeMap::View& view, const Scratch& scratch,
                           Beams& beams, double* log_p) const {
  const ScanBeams& all = scratch.beams;
  std::array<NodeOutline::Reach, kBlock> reach;
  std::array<double, kBlock> expected_m;
  map_->reach(view, std::span(beams.direction.data(), beams.count),
              std::span(reach.data(), beams.count));
  const bool has_base = has_base_at(beams.laser_m);
  for (std::size_t k = 0; k < beams.count; ++k) {
    expected_m[k] = reach[k].end == NodeOutline::Edge::kSurface ? reach[k].range_m : kUnknown_m;
    if (!has_base || !reach[k].is_open_ended(all.r_max_m)) continue;
    if (!beams.is_cast) cast_in_base(laser, scratch, beams);
    expected_m[k] =
        beyond_m(beams.laser_m, beams.direction[k], reach[k].range_m, beams.base_m[k], all.r_max_m);
  }
  scratch.mixture.log_likelihoods(beams.begin, beams.count, expected_m.data(), log_p);
  if (has_base) return;
  for (std::size_t k = 0; k < beams.count; ++k) {
    if (!reach[k].is_open_ended(all.r_max_m)) continue;
    const std::size_t beam = beams.begin + k;
    if (all.is_hit[beam] != 0 && all.range_m[beam] < reach[k].range_m) {
      log_p[k] = scratch.log_within_free[beam];
      continue;
    }
    log_p[k] = rays::log_likelihood_of(scratch.mixture.mixture().likelihood_beyond(
        all.is_hit[beam] != 0, all.range_m[beam], reach[k].range_m));
  }
}

TimescaleModel::OfLevels TimescaleModel::log_p_of_levels(const Pose2& laser,
                                                         const BelievedLevels& levels,
                                                         const Scratch& scratch) const {
  const double c = std::cos(laser.theta);
  const double s = std::sin(laser.theta);
  std::array<NodeMap::View, BelievedLevels::kMax> views;
  for (std::size_t l = 0; l < levels.size(); ++l) {
    views[l] = map_->view(levels[l].level, laser.translation());
  }
  OfLevels sums{};
  std::array<double, kBlock> log_p;
  Beams beams;
  beams.laser_m = laser.translation();
  for (; beams.begin < scratch.beams.size(); beams.begin += kBlock) {
    beams.count = std::min(kBlock, scratch.beams.size() - beams.begin);
    beams.is_cast = false;
    for (std::size_t k = 0; k < beams.count; ++k) {
      const double beam_c = scratch.beams.cosine[beams.begin + k];
      const double beam_s = scratch.beams.sine[beams.begin + k];
      beams.direction[k] = {c * beam_c - s * beam_s, s * beam_c + c * beam_s};
    }
    for (std::size_t l = 0; l < levels.size(); ++l) {
      weigh(laser, views[l], scratch, beams, log_p.data());
      for (std::size_t k = 0; k < beams.count; ++k) sums[l] += log_p[k];
    }
  }
  return sums;
}

double TimescaleModel::mixed(const BelievedLevels& levels, OfLevels log_p) {
  for (std::size_t l = 0; l < levels.size(); ++l) log_p[l] += std::log(levels[l].weight);
  return log_sum_exp(std::span(log_p.data(), levels.size()));
}

void TimescaleModel::prepare(const Scan& scan, Scratch& scratch) const {
  ScanBeams& beams = scratch.beams;
  select_beams(scan, config_.beams, beams);
  const BeamMixture mixture = beam_mixture_.limited_to(beams.r_max_m);
  scratch.mixture.prepare(mixture, beams);
  scratch.log_within_free.resize(beams.size());
  for (std::size_t k = 0; k < beams.size(); ++k) {
    const double further_m = 0.5 * (beams.range_m[k] + beams.r_max_m);
    scratch.log_within_free[k] =
        rays::log_likelihood_of(mixture.likelihood_beyond(true, beams.range_m[k], further_m));
  }
}

std::size_t TimescaleModel::log_likelihoods(const Scan& scan,
                                            const localization::Weighing& weighing,
                                            localization::ParticleSet& particles,
                                            std::span<double> log_likelihood,
                                            WorkerPool& pool) const {
  const auto scratch = scratch_.acquire();
  prepare(scan, *scratch);
  const BelievedLevels levels = believed();
  constexpr std::size_t kChunk = 64;
  const auto weigh_chunk = [&](std::size_t begin, std::size_t end, std::size_t /*chunk*/) {
    for (std::size_t i = begin; i < end; ++i) {
      const Pose2 laser = particles.pose(i) * scratch->beams.robot_from_laser;
      log_likelihood[i] =
          mixed(levels, log_p_of_levels(laser, levels, *scratch)) / weighing.tempering;
    }
  };
  pool.for_chunks(particles.size(), kChunk, std::cref(weigh_chunk));
  return scratch->beams.size();
}

void TimescaleModel::weigh_levels(const Scan& scan, const Pose2& laser) {
  if (node_ < 0) return;
  const auto scratch = scratch_.acquire();
  prepare(scan, *scratch);
  if (scratch->beams.size() == 0) return;
  std::vector<double>& log_p = scratch->log_p_a_beam;
  log_p.resize(map_->level_names().size());
  for (std::size_t level = 0; level < log_p.size(); ++level) {
    BelievedLevels alone;
    alone.add({static_cast<int>(level), 1.0});
    log_p[level] =
        log_p_of_levels(laser, alone, *scratch)[0] / static_cast<double>(scratch->beams.size());
  }
  mixture_.update(node_, log_p);
}

std::unique_ptr<localization::SensorModel> TimescaleModel::for_one_run() const {
  if (!use_.goes_on_learning && use_.level) return nullptr;
  auto own = std::make_unique<TimescaleModel>(memory_, map_, config_, use_, base_);
  if (use_.goes_on_learning) own->own_memory_.emplace(*memory_);
  return own;
}

void TimescaleModel::learn(const Observation& observation, const Pose2Gaussian& map_from_robot,
                           const localization::PoseTrust& trust) {
  const Pose2 laser = map_from_robot.mean * observation.scan.robot_from_laser;
  if (!use_.level) {
    node_ = mixture_.node_at(*map_, laser.translation());
    weigh_levels(observation.scan, laser);
  }
  if (!own_memory_ || trust.is_in_doubt || trust.score < use_.min_score) return;
  posed_.run = observation.run;
  posed_.scan = observation.scan;
  posed_.map_from_robot = map_from_robot.mean;
  const memory::Observed observed = own_memory_->observe(posed_, &map_from_robot.covariance);
  if (observed.outcome != memory::ObserveOutcome::kTaken) return;
  map_ = own_memory_->decode(map_->decoding(), map_.get(), use_.unsettled_s);
}

void TimescaleModel::adopt(const SensorModel& before) {
  const auto* other = dynamic_cast<const TimescaleModel*>(&before);
  if (other == nullptr) return;
  mixture_.adopt(other->mixture_, *other->map_, *map_);
  if (other->node_ < 0) return;
  const auto& place = other->map_->nodes()[static_cast<std::size_t>(other->node_)].position_m;
  const auto same = std::find_if(map_->nodes().begin(), map_->nodes().end(),
                                 [&](const auto& node) { return node.position_m == place; });
  if (same != map_->nodes().end()) node_ = static_cast<int>(same - map_->nodes().begin());
}

}  // namespace strata::maps
