// SPDX-License-Identifier: Apache-2.0
#include "components/maps/timescale_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace strata::maps {
namespace {

using localization::BeamMixture;
using localization::ScanBeams;
using memory::NodeMap;
using memory::NodeOutline;

constexpr double kNothing = std::numeric_limits<double>::infinity();
/// Views of one particle's pose are kept on the stack.
constexpr std::size_t kMostLevels = 16;

std::vector<Eigen::Vector2d> directions_of(const ScanBeams& beams) {
  std::vector<Eigen::Vector2d> directions;
  for (const double bearing : beams.bearing_rad) {
    directions.emplace_back(std::cos(bearing), std::sin(bearing));
  }
  return directions;
}

double likelihood(const BeamMixture& mixture, bool is_hit, double range_m,
                  const NodeOutline::Reach& reach) {
  return reach.end == NodeOutline::Edge::kSurface
             ? mixture.likelihood(is_hit, range_m, reach.range_m)
             : mixture.likelihood_beyond(is_hit, range_m, reach.range_m);
}

}  // namespace

TimescaleModel::TimescaleModel(std::shared_ptr<const memory::TimescaleMemory> memory,
                               std::shared_ptr<const NodeMap> map,
                               const localization::BeamModelConfig& config, const TimescaleUse& use)
    : memory_(std::move(memory)),
      map_(std::move(map)),
      config_(config),
      use_(use),
      mixture_(use.mixture, map_->level_names().size()) {
  require_valid(config, "beam_model");
}

std::vector<TimescaleModel::Believed> TimescaleModel::believed() const {
  if (use_.level) return {{*use_.level, 1.0}};
  std::vector<Believed> levels;
  for (const double weight : mixture_.weights(node_)) {
    levels.push_back({static_cast<int>(levels.size()), weight});
  }
  std::stable_sort(levels.begin(), levels.end(),
                   [](const Believed& a, const Believed& b) { return a.weight > b.weight; });
  if (levels.size() > kMostLevels) levels.resize(kMostLevels);
  return levels;
}

std::size_t TimescaleModel::log_likelihoods(const Scan& scan, double tempering,
                                            localization::ParticleSet& particles,
                                            std::span<double> log_likelihood,
                                            WorkerPool& pool) const {
  const ScanBeams beams = select_beams(scan, config_.beams);
  const std::vector<Eigen::Vector2d> directions = directions_of(beams);
  const BeamMixture mixture(config_.mixture, beams.r_max_m);
  const std::vector<Believed> levels = believed();
  constexpr std::size_t kChunk = 64;
  pool.for_chunks(particles.size(), kChunk, [&](std::size_t begin, std::size_t end, std::size_t) {
    std::array<NodeMap::View, kMostLevels> views;
    for (std::size_t i = begin; i < end; ++i) {
      const Pose2 laser = particles.pose(i) * beams.robot_from_laser;
      for (std::size_t l = 0; l < levels.size(); ++l) {
        views[l] = map_->view(levels[l].level, laser.translation());
      }
      const double c = std::cos(laser.theta);
      const double s = std::sin(laser.theta);
      double sum = 0.0;
      for (std::size_t k = 0; k < beams.size(); ++k) {
        const Eigen::Vector2d& d = directions[k];
        const Eigen::Vector2d direction(c * d.x() - s * d.y(), s * d.x() + c * d.y());
        double p = 0.0;
        for (std::size_t l = 0; l < levels.size(); ++l) {
          p += levels[l].weight * likelihood(mixture, beams.is_hit[k] != 0, beams.range_m[k],
                                             map_->reach(views[l], direction));
        }
        sum += std::log(p);
      }
      log_likelihood[i] = sum / tempering;
    }
  });
  return beams.size();
}

double TimescaleModel::explained_share(const Scan& scan, const Pose2& map_from_robot,
                                       const localization::ParticleSet& /*particles*/) const {
  const ScanBeams beams = select_beams(scan, config_.beams);
  if (beams.size() == 0) return 1.0;
  const BeamMixture mixture(config_.mixture, beams.r_max_m);
  const Pose2 laser = map_from_robot * beams.robot_from_laser;
  const std::vector<Believed> levels = believed();
  std::size_t explained = 0;
  for (std::size_t k = 0; k < beams.size(); ++k) {
    const double angle = laser.theta + beams.bearing_rad[k];
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    explained += std::any_of(levels.begin(), levels.end(), [&](const Believed& level) {
      const auto reach = map_->reach(map_->view(level.level, laser.translation()), direction);
      // What lies beyond a free way is unknown: a beam that goes as far is as expected.
      if (reach.end != NodeOutline::Edge::kSurface && reach.range_m < beams.r_max_m) {
        return reach.end != NodeOutline::Edge::kUnseen && beams.range_m[k] >= reach.range_m;
      }
      return mixture.explains(beams.is_hit[k] != 0, beams.range_m[k], reach.range_m);
    });
  }
  return static_cast<double>(explained) / static_cast<double>(beams.size());
}

std::unique_ptr<localization::SensorModel> TimescaleModel::for_one_run() const {
  if (!use_.goes_on_learning && use_.level) return nullptr;
  auto own = std::make_unique<TimescaleModel>(memory_, map_, config_, use_);
  if (use_.goes_on_learning) own->own_memory_.emplace(*memory_);
  return own;
}

void TimescaleModel::learn(const Observation& observation, const Pose2Gaussian& map_from_robot) {
  const Pose2 laser = map_from_robot.mean * observation.scan.robot_from_laser;
  if (!use_.level) {
    mixture_.update(*map_, laser, observation.scan);
    node_ = mixture_.node_at(*map_, laser.translation());
  }
  if (!own_memory_) return;
  PosedScan posed;
  posed.run = observation.run;
  posed.scan = observation.scan;
  posed.map_from_robot = map_from_robot.mean;
  const memory::Observed observed = own_memory_->observe(posed, &map_from_robot.covariance);
  if (observed.outcome != memory::ObserveOutcome::kTaken) return;
  map_ = own_memory_->decode(map_->decoding(), map_.get(), use_.unsettled_s);
}

double TimescaleModel::expected_range_m(const Pose2& map_from_laser, double bearing_rad) const {
  const double angle = map_from_laser.theta + bearing_rad;
  const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
  for (const Believed& level : believed()) {
    const auto reach =
        map_->reach(map_->view(level.level, map_from_laser.translation()), direction);
    if (reach.end == NodeOutline::Edge::kSurface) return reach.range_m;
    if (reach.end == NodeOutline::Edge::kOpen) return kNothing;
  }
  return kNothing;
}

}  // namespace strata::maps
