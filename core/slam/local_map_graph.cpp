// SPDX-License-Identifier: Apache-2.0
#include "core/slam/local_map_graph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include <Eigen/LU>

#include "core/base/make_room.hpp"
#include "core/slam/local_map_agreement.hpp"

namespace strata::slam {
namespace {

/// A closure whose squared error stays above this (3 degrees of freedom) is wrong.
constexpr double kWrongClosure = 50.0;
/// A given pose of this share of a closure's uncertainty is not moved by one.
constexpr double kSettledShare = 0.25;
/// Closures count as this much path, so that places closed once are searched narrowly later.
constexpr double kClosurePathM = 0.5;

Eigen::Matrix3d symmetric(const Eigen::Matrix3d& matrix) {
  return 0.5 * (matrix + matrix.transpose());
}

Endpoints cloud_of(const LocalMap& local_map, int max_points) {
  Endpoints cloud;
  for (std::size_t i = 0; i < local_map.points.size(); ++i) {
    cloud.x_m.push_back(local_map.points[i].x_m);
    cloud.y_m.push_back(local_map.points[i].y_m);
    cloud.beam.push_back(static_cast<std::uint32_t>(i));
  }
  return subsample(cloud, static_cast<std::size_t>(max_points));
}

}  // namespace

LocalMapGraph::LocalMapGraph(const ClosureConfig& config, const registration::MatchConfig& match,
                             const registration::MatchFieldConfig& field, double resolution_m,
                             WorkerPool& pool)
    : config_(config),
      match_(match),
      field_(field),
      resolution_m_(resolution_m),
      pool_(pool),
      graph_(config.graph) {}

LocalMapGraph::~LocalMapGraph() = default;

/// A local map is added to all lists or to none, where memory runs out.
void LocalMapGraph::make_room() {
  graph_.make_room();
  make_room_for_one(chain_);
  make_room_for_one(located_);
  make_room_for_one(clouds_);
  make_room_for_one(breadths_m_);
  make_room_for_one(given_);
  make_room_for_one(local_maps_);
}

std::size_t LocalMapGraph::add(LocalMap local_map, const std::optional<Pose2Gaussian>& given) {
  make_room();
  Endpoints cloud = cloud_of(local_map, config_.max_points);
  const std::size_t index = local_maps_.size();
  const bool continues = index > 0 && local_maps_.back().run == local_map.run;
  Pose2 pose = local_map.run_from_local_map;
  if (given) {
    pose = given->mean;
  } else if (continues) {
    pose = map_from_run(index - 1) * local_map.run_from_local_map;
  }
  graph_.add_node(pose);
  if (given) graph_.add_prior({index, given->mean, given->covariance.inverse(), false});
  if (continues) {
    pose_graph::Edge edge;
    edge.from = index - 1;
    edge.to = index;
    edge.from_from_to =
        between(local_maps_.back().run_from_local_map, local_map.run_from_local_map);
    const double length_m = std::hypot(edge.from_from_to.x, edge.from_from_to.y);
    const OdometryNoiseConfig noise{config_.chain_floor_m, config_.chain_per_metre_m,
                                    config_.chain_floor_rad, config_.chain_per_metre_rad, 0.0};
    // Where the matches were ambiguous (along a bare corridor) the chain gives way.
    Eigen::Matrix3d covariance = local_map.from_previous;
    covariance.diagonal() +=
        odometry_step(edge.from_from_to, length_m, noise).covariance.diagonal();
    edge.information = symmetric(covariance.inverse());
    graph_.add_edge(edge);
    chain_.push_back(edge);
  }
  located_.push_back(given.has_value() || (continues ? located_.back() : index == 0));
  breadths_m_.push_back(breadth_m(cloud));
  clouds_.push_back(std::move(cloud));
  given_.push_back(given);
  local_maps_.push_back(std::move(local_map));
  if (!located_[index]) {
    // The longer the run, the less can it be mistaken; each try costs as much as all before.
    std::size_t length = 1;
    while (length <= index && local_maps_[index - length].run == local_maps_[index].run) ++length;
    if ((length & (length - 1)) == 0) locate_run(index);
  }
  if (config_.enabled && located_[index]) search_closures(index);
  return index;
}

Agreement LocalMapGraph::agreement(std::size_t a, std::size_t b, const Pose2& a_from_b) const {
  return agreement_with(local_maps_[a].states, local_maps_[b].points,
                        [&](const registration::SurfacePoint& point) {
                          return a_from_b * Eigen::Vector2d(point.x_m, point.y_m);
                        });
}

bool LocalMapGraph::is_settled(std::size_t index) const {
  if (!given_[index]) return false;
  const Eigen::Matrix3d& covariance = given_[index]->covariance;
  const double stddev_m = std::sqrt(std::max(covariance(0, 0), covariance(1, 1)));
  return stddev_m <= kSettledShare * config_.stddev_m &&
         std::sqrt(covariance(2, 2)) <= kSettledShare * config_.stddev_rad;
}

/// Those that are settled lie in one frame: from one to any other is as near as a closure.
std::vector<double> LocalMapGraph::path_lengths(std::size_t from) const {
  std::vector<std::vector<std::pair<std::size_t, double>>> links(local_maps_.size());
  for (std::size_t i = 0; i < graph_.edges().size(); ++i) {
    if (!graph_.edge_enabled(i)) continue;
    const pose_graph::Edge& edge = graph_.edges()[i];
    const double length_m =
        edge.robust ? kClosurePathM : std::hypot(edge.from_from_to.x, edge.from_from_to.y);
    links[edge.from].emplace_back(edge.to, length_m);
    links[edge.to].emplace_back(edge.from, length_m);
  }
  std::vector<double> lengths(local_maps_.size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  lengths[from] = 0.0;
  open.emplace(0.0, from);
  const auto reach = [&](std::size_t node, double length) {
    if (length >= lengths[node]) return;
    lengths[node] = length;
    open.emplace(length, node);
  };
  bool reached_settled = false;
  while (!open.empty()) {
    const auto [length, node] = open.top();
    open.pop();
    if (length > lengths[node]) continue;
    for (const auto& [next, more] : links[node]) reach(next, length + more);
    if (reached_settled || !is_settled(node)) continue;
    reached_settled = true;
    for (std::size_t i = 0; i < local_maps_.size(); ++i) {
      if (is_settled(i)) reach(i, length + kClosurePathM);
    }
  }
  return lengths;
}

void LocalMapGraph::add_closure(const Closure& closure) {
  pose_graph::Edge edge;
  edge.from = closure.a;
  edge.to = closure.b;
  edge.from_from_to = closure.a_from_b.mean;
  edge.information = symmetric(closure.a_from_b.covariance.inverse());
  edge.robust = true;
  graph_.add_edge(edge);
}

void LocalMapGraph::optimize() {
  graph_.optimize();
  bool dropped = false;
  for (std::size_t i = 0; i < graph_.edges().size(); ++i) {
    if (!graph_.edges()[i].robust || !graph_.edge_enabled(i)) continue;
    if (graph_.squared_error(i) <= kWrongClosure) continue;
    graph_.disable_edge(i);
    dropped = true;
  }
  if (dropped) graph_.optimize();
}

std::size_t LocalMapGraph::closures() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < graph_.edges().size(); ++i) {
    if (graph_.edges()[i].robust && graph_.edge_enabled(i)) ++count;
  }
  return count;
}

void LocalMapGraph::rebuild_graph(const std::vector<Closure>& closures) {
  pose_graph::PoseGraph graph(config_.graph);
  for (std::size_t i = 0; i < size(); ++i) {
    graph.add_node(graph_.pose(i));
    if (given_[i]) graph.add_prior({i, given_[i]->mean, given_[i]->covariance.inverse(), false});
  }
  for (const pose_graph::Edge& edge : chain_) graph.add_edge(edge);
  graph_ = std::move(graph);
  for (const Closure& closure : closures) add_closure(closure);
  optimize();
}

void LocalMapGraph::measure_breadths() {
  breadths_m_.clear();
  for (const Endpoints& cloud : clouds_) breadths_m_.push_back(breadth_m(cloud));
}

void LocalMapGraph::forget_surfaces() {
  cache_.clear();
  for (Endpoints& cloud : clouds_) cloud = {};
  for (LocalMap& local_map : local_maps_) {
    local_map.points = {};
    local_map.states = StateGrid(resolution_m_, CellRect{}, SurfaceState::kUnknown);
  }
}

bool LocalMapGraph::is_sound() const {
  const std::size_t count = local_maps_.size();
  const auto joins_known = [&](const pose_graph::Edge& edge) {
    return edge.from < count && edge.to < count;
  };
  return clouds_.size() == count && given_.size() == count && located_.size() == count &&
         graph_.size() == count && graph_.is_sound() &&
         std::all_of(chain_.begin(), chain_.end(), joins_known);
}

}  // namespace strata::slam
