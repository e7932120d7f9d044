// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/level_mixture.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/base/config.hpp"

namespace strata::memory {
namespace {

/// The slowest level has what the others leave.
std::vector<double> start_of(double unearned, std::size_t levels) {
  const double even = 1.0 / static_cast<double>(levels);
  std::vector<double> start(levels, std::min(unearned, even));
  start.back() = 1.0 - start.front() * static_cast<double>(levels - 1);
  return start;
}

}  // namespace

LevelMixture::LevelMixture(const LevelMixtureConfig& config, std::size_t levels)
    : config_(config), start_(start_of(config.unearned, levels)), score_(levels) {
  require_valid(config, "level_mixture");
}

std::span<const double> LevelMixture::weights(int node) const {
  const auto index = static_cast<std::size_t>(node);
  return node >= 0 && index < weights_.size() ? weights_[index] : start_;
}

int LevelMixture::node_at(const NodeMap& map, const Eigen::Vector2d& point_m) {
  for (std::size_t level = 0; level < map.level_names().size(); ++level) {
    if (const int node = map.node_at(static_cast<int>(level), point_m); node >= 0) return node;
  }
  return -1;
}

void LevelMixture::adopt(const LevelMixture& before, const NodeMap& map_before,
                         const NodeMap& map) {
  if (before.start_.size() != start_.size()) return;
  std::map<std::pair<double, double>, std::size_t> known;
  for (std::size_t n = 0; n < before.weights_.size() && n < map_before.nodes().size(); ++n) {
    const Eigen::Vector2d& place = map_before.nodes()[n].position_m;
    known.emplace(std::pair(place.x(), place.y()), n);
  }
  weights_.assign(map.nodes().size(), start_);
  for (std::size_t n = 0; n < weights_.size(); ++n) {
    const Eigen::Vector2d& place = map.nodes()[n].position_m;
    const auto found = known.find(std::pair(place.x(), place.y()));
    if (found != known.end()) weights_[n] = before.weights_[found->second];
  }
}

void LevelMixture::update(int node, std::span<const double> log_p_a_beam) {
  if (node < 0) return;
  if (static_cast<std::size_t>(node) >= weights_.size()) {
    weights_.resize(static_cast<std::size_t>(node) + 1, start_);
  }
  std::vector<double>& weights = weights_[static_cast<std::size_t>(node)];
  for (std::size_t level = 0; level < weights.size(); ++level) {
    score_[level] = std::log(weights[level]) + config_.effective_beams * log_p_a_beam[level];
  }
  const double best = *std::max_element(score_.begin(), score_.end());
  double total = 0.0;
  for (double& value : score_) total += value = std::exp(value - best);
  for (std::size_t level = 0; level < weights.size(); ++level) {
    weights[level] =
        (1.0 - config_.forgetting) * score_[level] / total + config_.forgetting * start_[level];
  }
}

}  // namespace strata::memory
