// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/timescale_memory.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "core/geometry/angle.hpp"
#include "core/random/stream.hpp"
#include "memory/decoding/decode.hpp"
#include "memory/nodes/config_bytes.hpp"

namespace strata::memory {
namespace {

/// 2: a node may gather a day. Memories of version 1 have no level that learns by days.
constexpr std::uint32_t kStateVersion = 2;
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
    const double squared = (nodes_[n].position_m - point_m).squaredNorm();
    if (squared <= radius_squared) near_.emplace_back(std::sqrt(squared), static_cast<int>(n));
  }
  std::sort(near_.begin(), near_.end());
}

int TimescaleMemory::add_node(const Eigen::Vector2d& position_m) {
  MemoryNode node;
  node.position_m = position_m;
  int day_samples = 0;
  for (const LevelConfig& level : config_.levels) {
    node.levels.emplace_back(config_.bins(), level.samples, config_.coupled_eviction);
    if (level.learns_by_days()) day_samples = std::max(day_samples, level.samples);
  }
  if (day_samples > 0) node.today.emplace(config_.bins(), day_samples);
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

bool TimescaleMemory::is_due(const MemoryNode& node, const PosedScan& scan) const {
  if (node.observations == 0 || node.last_run != scan.run) return true;
  // Logs exist whose stamps run backwards here and there.
  const std::int64_t elapsed_ns = std::abs((scan.scan.stamp - node.last_stamp).ns);
  if (Duration{elapsed_ns}.seconds() >= config_.period_s) return true;
  if (translation_distance(node.last_pose, scan.map_from_robot) >= config_.travel_m) return true;
  const double turn = angle_difference(node.last_pose.theta, scan.map_from_robot.theta);
  return std::abs(turn) >= config_.turn_rad;
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
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    MemoryNode& node = nodes_[n];
    if (node.today && !node.today->empty()) absorb_day(node, static_cast<int>(n));
  }
}

Observed TimescaleMemory::choose_node(const PosedScan& scan) {
  const Eigen::Vector2d laser_m = scan.map_from_laser().translation();
  find_near(laser_m);
  for (const auto& [distance_m, node] : near_) {
    if (distance_m > config_.update_radius_m) return {ObserveOutcome::kFarAway, node, false};
    const MemoryNode& candidate = nodes_[static_cast<std::size_t>(node)];
    if (!is_due(candidate, scan)) return {ObserveOutcome::kTooSoon, node, false};
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

Observed TimescaleMemory::observe(const PosedScan& scan, const Eigen::Matrix3d* covariance) {
  if (!is_finite(scan.map_from_robot) || (covariance != nullptr && !is_certain(*covariance))) {
    return {ObserveOutcome::kUncertain, -1, false};
  }
  const Observed result = choose_node(scan);
  if (result.outcome != ObserveOutcome::kTaken) return result;
  MemoryNode& node = nodes_[static_cast<std::size_t>(result.node)];
  insert(node, result.node, scan);
  ++observations_;
  newest_run_ = scan.run;
  newest_stamp_ = scan.scan.stamp;
  ++node.observations;
  node.last_run = scan.run;
  node.last_stamp = scan.scan.stamp;
  node.last_pose = scan.map_from_robot;
  return result;
}

bool TimescaleMemory::is_settled(const MemoryNode& node, double unsettled_s) const {
  return unsettled_s <= 0.0 || node.last_run != newest_run_ ||
         std::abs((newest_stamp_ - node.last_stamp).seconds()) >= unsettled_s;
}

std::shared_ptr<const NodeMap> TimescaleMemory::decode(const DecodingConfig& decoding,
                                                       const NodeMap* previous,
                                                       double unsettled_s) const {
  const bool reusable = previous != nullptr && previous->decoding() == decoding;
  const NodeLevel nothing(config_.bins(), 1, false);
  std::vector<NodeMap::Node> nodes;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    NodeMap::Node node{nodes_[n].position_m, nodes_[n].observations, {}};
    const bool settled = is_settled(nodes_[n], unsettled_s);
    const bool has_old = reusable && n < previous->nodes().size();
    for (std::size_t level = 0; level < nodes_[n].levels.size(); ++level) {
      const NodeLevel& source = settled ? nodes_[n].levels[level] : nothing;
      const auto old = has_old ? previous->nodes()[n].levels[level] : nullptr;
      if (old != nullptr && (!settled || old->insertions == source.insertions())) {
        node.levels.push_back(old);
        continue;
      }
      node.levels.push_back(NodeMap::make_level(config_.bins(), config_.visibility.own_place_m,
                                                source.insertions(),
                                                memory::decode(source, decoding)));
    }
    nodes.push_back(std::move(node));
  }
  std::vector<std::string> names;
  for (const LevelConfig& level : config_.levels) names.push_back(level.name);
  return std::make_shared<const NodeMap>(config_.bins(), decoding, std::move(names),
                                         std::move(nodes), previous);
}

std::vector<std::byte> TimescaleMemory::head_state() const {
  ByteWriter out;
  out.write(kStateVersion);
  write_config(config_, out);
  out.write(seed_);
  out.write(observations_);
  out.write(static_cast<std::uint64_t>(nodes_.size()));
  return std::move(out).take();
}

TimescaleMemory::NodeState TimescaleMemory::node_state(std::size_t index) const {
  const MemoryNode& node = nodes_[index];
  ByteWriter head;
  head.write(node.position_m.x());
  head.write(node.position_m.y());
  head.write(node.observations);
  head.write(static_cast<std::int64_t>(node.last_run));
  head.write(node.last_stamp.ns);
  head.write(node.last_pose.x);
  head.write(node.last_pose.y);
  head.write(node.last_pose.theta);
  NodeState state{std::move(head).take(), {}};
  for (const NodeLevel& level : node.levels) {
    ByteWriter out;
    level.write(out);
    state.levels.push_back(std::move(out).take());
  }
  if (node.today) {
    ByteWriter out;
    node.today->write(out);
    state.levels.push_back(std::move(out).take());
  }
  return state;
}

std::vector<std::byte> TimescaleMemory::state() const {
  std::vector<std::byte> all = head_state();
  auto append = [&all](const std::vector<std::byte>& part) {
    all.insert(all.end(), part.begin(), part.end());
  };
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const NodeState node = node_state(n);
    append(node.head);
    for (const auto& level : node.levels) append(level);
  }
  return all;
}

std::size_t TimescaleMemory::bytes() const {
  // A node's head and, per level, insertions and two counts an angle bin.
  constexpr std::size_t kHeadBytes = 64;
  std::size_t total = head_state().size();
  for (const MemoryNode& node : nodes_) {
    total += kHeadBytes;
    for (const NodeLevel& level : node.levels) {
      total += 8 + 4 * static_cast<std::size_t>(config_.angle_bins);
      total += level.sample_count() * sizeof(float) + level.pair_count() * sizeof(RangePair);
    }
    if (node.today) total += node.today->bytes();
  }
  return total;
}

TimescaleMemory TimescaleMemory::restore(std::span<const std::byte> head,
                                         std::span<const NodeState> nodes,
                                         const std::string& place) {
  ByteReader in(head, place);
  if (const auto version = in.read<std::uint32_t>(); version > kStateVersion) {
    in.fail("was written by a newer Strata");
  }
  TimescaleConfig config = read_config(in);
  const auto seed = in.read<std::uint64_t>();
  TimescaleMemory memory(std::move(config), seed);
  memory.observations_ = in.read<std::uint64_t>();
  if (in.read<std::uint64_t>() != nodes.size()) in.fail("lacks nodes");
  in.finish();
  for (const NodeState& state : nodes) {
    ByteReader node_in(state.head, place);
    const double x = node_in.read<double>();
    const double y = node_in.read<double>();
    MemoryNode& node = memory.nodes_[static_cast<std::size_t>(memory.add_node({x, y}))];
    node.observations = node_in.read<std::uint64_t>();
    node.last_run = static_cast<int>(node_in.read<std::int64_t>());
    node.last_stamp.ns = node_in.read<std::int64_t>();
    node.last_pose.x = node_in.read<double>();
    node.last_pose.y = node_in.read<double>();
    node.last_pose.theta = node_in.read<double>();
    node_in.finish();
    if (state.levels.size() != node.levels.size() + (node.today ? 1U : 0U)) {
      node_in.fail("lacks levels");
    }
    for (std::size_t level = 0; level < node.levels.size(); ++level) {
      ByteReader level_in(state.levels[level], place);
      node.levels[level].read(level_in);
      level_in.finish();
    }
    if (node.today) {
      ByteReader day_in(state.levels.back(), place);
      node.today->read(day_in);
      day_in.finish();
    }
  }
  return memory;
}

}  // namespace strata::memory
