// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/timescale_memory.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/random/stream.hpp"

namespace strata::memory {
namespace {

/// Random numbers of one observation: each level its own, the day's sample, and each node's day.
constexpr std::uint32_t kDaySample = 255;
constexpr std::uint32_t kDayEnd = 256;

TimescaleConfig checked(TimescaleConfig config) {
  require_valid(config, "timescale");
  return config;
}

}  // namespace

TimescaleMemory::TimescaleMemory(TimescaleConfig config, std::uint64_t seed)
    : config_(checked(std::move(config))),
      seed_(seed),
      scanner_(config_.bins(), config_.visibility) {
  for (const LevelConfig& level : config_.levels) {
    insertion_probability_.push_back(
        level.learns_by_days() ? 0.0
                               : std::min(1.0, level.insertion_probability(config_.period_s)));
  }
}

void TimescaleMemory::find_near(const Eigen::Vector2d& point_m) {
  near_.clear();
  const double radius_squared = config_.node_spacing_m * config_.node_spacing_m;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    if (nodes_[n].is_damaged) continue;
    const double squared = (nodes_[n].position_m - point_m).squaredNorm();
    if (squared <= radius_squared) near_.emplace_back(std::sqrt(squared), static_cast<int>(n));
  }
  std::sort(near_.begin(), near_.end());
}

void TimescaleMemory::allocate(MemoryNode& node) const {
  int day_samples = 0;
  for (const LevelConfig& level : config_.levels) {
    node.levels.emplace_back(config_.bins(), level.samples, config_.coupled_eviction);
    if (level.learns_by_days()) day_samples = std::max(day_samples, level.samples);
  }
  if (day_samples > 0) node.today.emplace(config_.bins(), day_samples);
}

int TimescaleMemory::add_node(const Eigen::Vector2d& position_m) {
  MemoryNode node;
  node.position_m = position_m;
  allocate(node);
  nodes_.push_back(std::move(node));
  return static_cast<int>(nodes_.size()) - 1;
}

double TimescaleMemory::insertion_probability(const MemoryNode& node, std::size_t level) const {
  const double steady = insertion_probability_[level];
  if (!config_.warm_up) return steady;
  const double even =
      node.levels[level].capacity() / (static_cast<double>(node.observations) + 1.0);
  return std::max(steady, std::min(1.0, even));
}

bool TimescaleMemory::is_due(const MemoryNode& node, const PosedScan& scan, int robot) const {
  if (node.observations == 0 || node.last_run != scan.run) return true;
  // Logs exist whose stamps run backwards here and there.
  const std::int64_t elapsed_ns = std::abs((scan.scan.stamp - node.last_stamp).ns);
  if (Duration{elapsed_ns}.seconds() >= config_.period_s) return true;
  if (robot != node.last_robot) return false;  // where the other stands tells nothing of motion
  return has_moved(node.last_pose, scan.map_from_robot, config_.travel_m, config_.turn_rad);
}

bool TimescaleMemory::is_certain(const Eigen::Matrix3d& covariance) const {
  const double position_std = std::sqrt(std::max(covariance(0, 0), covariance(1, 1)));
  return position_std <= config_.max_position_std_m &&
         std::sqrt(covariance(2, 2)) <= config_.max_heading_std_rad;
}

void TimescaleMemory::insert(MemoryNode& node, int index, const PosedScan& scan) {
  for (std::size_t level = 0; level < node.levels.size(); ++level) {
    if (config_.levels[level].learns_by_days()) continue;
    RandomStream random(seed_, StreamId::kTimescale, observations_,
                        static_cast<std::uint32_t>(level));
    if (random.bernoulli(insertion_probability(node, level))) {
      node.levels[level].insert(virtual_scan_, random);
    }
  }
  if (!node.today) return;
  if (node.today->is_over(scan.run, scan.scan.stamp)) absorb_day(node, index);
  RandomStream random(seed_, StreamId::kTimescale, observations_, kDaySample);
  node.today->add(virtual_scan_, scan.run, scan.scan.stamp, random);
}

void TimescaleMemory::absorb_day(MemoryNode& node, int index) {
  const double days = node.today->days();
  for (std::size_t level = 0; level < node.levels.size(); ++level) {
    const LevelConfig& config = config_.levels[level];
    if (!config.learns_by_days()) continue;
    RandomStream random(
        seed_, StreamId::kTimescale, observations_,
        kDayEnd * (static_cast<std::uint32_t>(index) + 1) + static_cast<std::uint32_t>(level));
    node.levels[level].absorb(node.today->seen(), config.replaced_after(days), random);
  }
  node.today->close();
}

void TimescaleMemory::close_day() {
  const bool any = std::any_of(config_.levels.begin(), config_.levels.end(),
                               [](const LevelConfig& level) { return level.learns_by_days(); });
  for (std::size_t n = 0; any && n < nodes_.size(); ++n) {
    load(static_cast<int>(n));
    MemoryNode& node = nodes_[n];
    if (node.today && !node.today->empty()) absorb_day(node, static_cast<int>(n));
  }
}

Observed TimescaleMemory::choose_node(const PosedScan& scan, int robot) {
  const Eigen::Vector2d laser_m = scan.map_from_laser().translation();
  find_near(laser_m);
  for (const auto& [distance_m, node] : near_) {
    if (distance_m > config_.update_radius_m) return {ObserveOutcome::kFarAway, node, false};
    const MemoryNode& candidate = nodes_[static_cast<std::size_t>(node)];
    if (!is_due(candidate, scan, robot) || !turns_.has_turn())
      return {ObserveOutcome::kTooSoon, node, false};
    if (scanner_.transform(scan, candidate.position_m, virtual_scan_)) {
      return {ObserveOutcome::kTaken, node, false};
    }
  }
  // Nodes that a wall or a crowd hides: half the spacing keeps their number bounded all the same.
  const bool is_crowded = !near_.empty() && near_.front().first <= 0.5 * config_.node_spacing_m;
  if (is_crowded || !scanner_.transform(scan, laser_m, virtual_scan_)) {
    return {ObserveOutcome::kUnseen, near_.empty() ? -1 : near_.front().second, false};
  }
  return {ObserveOutcome::kTaken, add_node(laser_m), true};
}

Observed TimescaleMemory::observe(const PosedScan& scan, const Eigen::Matrix3d* covariance,
                                  int robot) {
  if (!is_finite(scan.map_from_robot) || (covariance != nullptr && !is_certain(*covariance))) {
    return {ObserveOutcome::kUncertain, -1, false};
  }
  turns_.see(scan.scan, scan.run);
  const Observed result = choose_node(scan, robot);
  if (result.outcome != ObserveOutcome::kTaken) return result;
  load(result.node);
  turns_.use();
  MemoryNode& node = nodes_[static_cast<std::size_t>(result.node)];
  insert(node, result.node, scan);
  ++observations_;
  node.last_used = observations_;
  newest_node_ = static_cast<std::size_t>(result.node);
  newest_run_ = scan.run;
  newest_stamp_ = scan.scan.stamp;
  ++node.observations;
  node.last_run = scan.run;
  node.last_robot = robot;
  node.last_stamp = scan.scan.stamp;
  node.last_pose = scan.map_from_robot;
  return result;
}

bool TimescaleMemory::is_settled(const MemoryNode& node, double unsettled_s) const {
  return unsettled_s <= 0.0 || node.last_run != newest_run_ ||
         std::abs((newest_stamp_ - node.last_stamp).seconds()) >= unsettled_s;
}

}  // namespace strata::memory
