// SPDX-License-Identifier: Apache-2.0
#include "components/maps/timescale_model.hpp"

#include <cmath>
#include <cstddef>
#include <limits>

namespace strata::maps {

using localization::BeamMixture;
using localization::ScanBeams;

double LevelRanges::expected_range_m(const Pose2& map_from_laser, double bearing_rad) const {
  const auto range_m =
      static_cast<double>(map_->expected_range_m(level_, map_from_laser, bearing_rad));
  return std::isnan(range_m) ? std::numeric_limits<double>::infinity() : range_m;
}

LevelMixtureModel::LevelMixtureModel(std::shared_ptr<const memory::NodeMap> map,
                                     const localization::BeamModelConfig& config)
    : config_(config) {
  require_valid(config, "beam_model");
  const auto count = static_cast<int>(map->level_names().size());
  for (int level = 0; level < count; ++level) levels_.emplace_back(map, level);
}

std::size_t LevelMixtureModel::log_likelihoods(const Scan& scan, double tempering,
                                               localization::ParticleSet& particles,
                                               std::span<double> log_likelihood,
                                               WorkerPool& pool) const {
  const ScanBeams beams = select_beams(scan, config_.beams);
  const BeamMixture mixture(config_.mixture, beams.r_max_m);
  const double share = 1.0 / static_cast<double>(levels_.size());
  constexpr std::size_t kChunk = 64;
  pool.for_chunks(particles.size(), kChunk, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (std::size_t i = begin; i < end; ++i) {
      const Pose2 laser = particles.pose(i) * beams.robot_from_laser;
      double sum = 0.0;
      for (std::size_t k = 0; k < beams.size(); ++k) {
        double likelihood = 0.0;
        for (const LevelRanges& level : levels_) {
          likelihood +=
              share * mixture.likelihood(beams.is_hit[k] != 0, beams.range_m[k],
                                         level.expected_range_m(laser, beams.bearing_rad[k]));
        }
        sum += std::log(likelihood);
      }
      log_likelihood[i] = sum / tempering;
    }
  });
  return beams.size();
}

double LevelMixtureModel::explained_share(const Scan& scan, const Pose2& map_from_robot,
                                          const localization::ParticleSet& /*particles*/) const {
  const ScanBeams beams = select_beams(scan, config_.beams);
  if (beams.size() == 0) return 1.0;
  const BeamMixture mixture(config_.mixture, beams.r_max_m);
  const Pose2 laser = map_from_robot * beams.robot_from_laser;
  std::size_t explained = 0;
  for (std::size_t k = 0; k < beams.size(); ++k) {
    for (const LevelRanges& level : levels_) {
      const double expected = level.expected_range_m(laser, beams.bearing_rad[k]);
      if (!mixture.explains(beams.is_hit[k] != 0, beams.range_m[k], expected)) continue;
      ++explained;
      break;
    }
  }
  return static_cast<double>(explained) / static_cast<double>(beams.size());
}

}  // namespace strata::maps
