// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/level_mixture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "core/base/config.hpp"

namespace strata::memory {
namespace {

constexpr std::size_t kMaxBeams = 60;

}  // namespace

LevelMixture::LevelMixture(const LevelMixtureConfig& config, std::size_t levels)
    : config_(config), even_(levels, 1.0 / static_cast<double>(levels)) {
  require_valid(config, "level_mixture");
}

std::span<const double> LevelMixture::weights(int node) const {
  const auto index = static_cast<std::size_t>(node);
  return node >= 0 && index < weights_.size() ? weights_[index] : even_;
}

int LevelMixture::node_at(const NodeMap& map, const Eigen::Vector2d& point_m) {
  for (std::size_t level = 0; level < map.level_names().size(); ++level) {
    if (const int node = map.node_at(static_cast<int>(level), point_m); node >= 0) return node;
  }
  return -1;
}

double LevelMixture::log_likelihood(std::span<const float> expected_m,
                                    std::span<const float> measured_m, double max_m) const {
  const double peak = config_.hit / (config_.sigma_m * std::sqrt(2.0 * std::numbers::pi));
  const double floor = (1.0 - config_.hit) / max_m;
  double sum = 0.0;
  for (std::size_t i = 0; i < expected_m.size(); ++i) {
    // A level that knows nothing gets what an even distribution would.
    double p = 1.0 / max_m;
    if (std::isinf(expected_m[i])) {
      p = static_cast<double>(measured_m[i]) >= max_m ? config_.hit : floor;
    } else if (!std::isnan(expected_m[i])) {
      const double z = static_cast<double>(measured_m[i] - expected_m[i]) / config_.sigma_m;
      p = peak * std::exp(-0.5 * z * z) + floor;
    }
    sum += std::log(p);
  }
  return sum / static_cast<double>(expected_m.size());
}

void LevelMixture::adopt(const LevelMixture& before, const NodeMap& map_before,
                         const NodeMap& map) {
  if (before.even_.size() != even_.size()) return;
  std::map<std::pair<double, double>, std::size_t> known;
  for (std::size_t n = 0; n < before.weights_.size() && n < map_before.nodes().size(); ++n) {
    const Eigen::Vector2d& place = map_before.nodes()[n].position_m;
    known.emplace(std::pair(place.x(), place.y()), n);
  }
  weights_.assign(map.nodes().size(), even_);
  for (std::size_t n = 0; n < weights_.size(); ++n) {
    const Eigen::Vector2d& place = map.nodes()[n].position_m;
    const auto found = known.find(std::pair(place.x(), place.y()));
    if (found != known.end()) weights_[n] = before.weights_[found->second];
  }
}

int LevelMixture::update(const NodeMap& map, const Pose2& map_from_laser, const Scan& scan) {
  const int node = node_at(map, map_from_laser.translation());
  if (node < 0) return -1;
  auto& [bearings, measured, expected, score] = scratch_;
  bearings.clear();
  measured.clear();
  const std::size_t step = std::max<std::size_t>(1, (scan.size() + kMaxBeams - 1) / kMaxBeams);
  for (std::size_t beam = 0; beam < scan.size(); beam += step) {
    const BeamKind kind = scan.kind(beam);
    if (kind != BeamKind::kHit && kind != BeamKind::kNoReturn) continue;
    bearings.push_back(scan.bearing_rad(beam));
    measured.push_back(kind == BeamKind::kHit ? scan.ranges_m[beam]
                                              : std::numeric_limits<float>::infinity());
  }
  if (bearings.empty()) return -1;
  if (static_cast<std::size_t>(node) >= weights_.size()) {
    weights_.resize(static_cast<std::size_t>(node) + 1, even_);
  }
  std::vector<double>& weights = weights_[static_cast<std::size_t>(node)];
  score.resize(weights.size());
  expected.resize(bearings.size());
  for (std::size_t level = 0; level < weights.size(); ++level) {
    map.expected_ranges_m(static_cast<int>(level), map_from_laser, bearings, expected);
    score[level] =
        std::log(weights[level]) +
        config_.effective_beams * log_likelihood(expected, measured, map.bins().max_range_m);
  }
  const double best = *std::max_element(score.begin(), score.end());
  double total = 0.0;
  for (double& value : score) total += value = std::exp(value - best);
  for (std::size_t level = 0; level < weights.size(); ++level) {
    weights[level] =
        (1.0 - config_.forgetting) * score[level] / total + config_.forgetting * even_[level];
  }
  return node;
}

}  // namespace strata::memory
