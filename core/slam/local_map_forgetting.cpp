// SPDX-License-Identifier: Apache-2.0
// Which local maps later ones have made superfluous, and how the graph does without them.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "core/slam/local_map_graph.hpp"

namespace strata::slam {
namespace {

/// The latest local maps of a run share scans, and the next one has an edge to them.
constexpr std::size_t kLatest = 4;
/// Cells that are looked at: every n-th, n a number that divides no usual width.
constexpr std::size_t kStride = 211;

/// The measurement as its other end sees it, covariance instead of information.
Pose2Gaussian seen_from(const pose_graph::Edge& edge, std::size_t node) {
  const Pose2Gaussian forth{edge.from_from_to, edge.information.inverse()};
  return edge.from == node ? forth : inverse(forth);
}

std::size_t other_end(const pose_graph::Edge& edge, std::size_t node) {
  return edge.from == node ? edge.to : edge.from;
}

bool joins(const pose_graph::Edge& edge, std::size_t a, std::size_t b) {
  return (edge.from == a && edge.to == b) || (edge.from == b && edge.to == a);
}

}  // namespace

/// Takes `node` out: its neighbours get edges to the one that its firmest edge leads to, by both
/// measurements one after the other. With two neighbours that marginalizes it exactly; with more,
/// what they say of each other by way of the node is told by way of that neighbour alone.
void LocalMapGraph::marginalize(std::vector<MeasuredEdge>& edges, std::size_t node) {
  std::vector<MeasuredEdge> own;
  const auto rest =
      std::stable_partition(edges.begin(), edges.end(), [&](const MeasuredEdge& measured) {
        return measured.edge.from != node && measured.edge.to != node;
      });
  own.assign(rest, edges.end());
  edges.erase(rest, edges.end());
  if (own.size() < 2) return;
  const auto firmest =
      std::min_element(own.begin(), own.end(), [&](const MeasuredEdge& a, const MeasuredEdge& b) {
        return seen_from(a.edge, node).covariance.trace() <
               seen_from(b.edge, node).covariance.trace();
      });
  const std::size_t hub = other_end(firmest->edge, node);
  const Pose2Gaussian hub_from_node = inverse(seen_from(firmest->edge, node));
  for (const MeasuredEdge& measured : own) {
    const std::size_t other = other_end(measured.edge, node);
    const bool known =
        other == hub || std::any_of(edges.begin(), edges.end(),
                                    [&](const auto& some) { return joins(some.edge, hub, other); });
    if (known) continue;
    const Pose2Gaussian across = hub_from_node * seen_from(measured.edge, node);
    MeasuredEdge marginal;
    marginal.edge.from = hub;
    marginal.edge.to = other;
    marginal.edge.from_from_to = across.mean;
    const Eigen::Matrix3d information = across.covariance.inverse();
    marginal.edge.information = 0.5 * (information + information.transpose());
    marginal.edge.robust = measured.edge.robust || firmest->edge.robust;
    marginal.lasting = true;
    edges.push_back(marginal);
  }
}

bool LocalMapGraph::is_superfluous(std::size_t index, const KeepConfig& keep) const {
  const LocalMap& local_map = local_maps_[index];
  if (local_map.points.empty()) return true;
  std::size_t known = 0;
  std::size_t own = 0;
  for (std::size_t k = 0; k < local_map.states.size(); k += kStride) {
    if (local_map.states.values()[k] == SurfaceState::kUnknown) continue;
    ++known;
    const Eigen::Vector2d at =
        graph_.pose(index) * local_map.states.center(local_map.states.cell(k));
    int views = 0;
    for (std::size_t later = size() - 1; later > index && views < keep.views; --later) {
      if (!same_frame(index, later)) continue;
      const Eigen::Vector2d there = inverse(graph_.pose(later)) * at;
      const StateGrid& states = local_maps_[later].states;
      views += states.get(states.cell_at(there)) != SurfaceState::kUnknown ? 1 : 0;
    }
    own += views < keep.views ? 1 : 0;
  }
  return static_cast<double>(own) < keep.own_share * static_cast<double>(known);
}

std::vector<std::size_t> LocalMapGraph::forget(const KeepConfig& keep, std::size_t before_scan) {
  std::vector<std::size_t> gone;
  if (size() <= kLatest) return gone;
  const CellRect& newest = local_maps_.back().states.rect();
  const double reach_m = resolution_m_ * std::hypot(newest.width(), newest.height());
  const Eigen::Vector2d center = graph_.pose(size() - 1) * local_maps_.back().center_m;
  for (std::size_t i = 0; i + kLatest < size(); ++i) {
    if (!same_frame(i, size() - 1) || local_maps_[i].last_scan > before_scan) continue;
    // Only where the newest one sees can an older one have become superfluous.
    const CellRect& rect = local_maps_[i].states.rect();
    const double both_m = reach_m + resolution_m_ * std::hypot(rect.width(), rect.height());
    if ((graph_.pose(i) * local_maps_[i].center_m - center).norm() > both_m) continue;
    if (is_superfluous(i, keep)) gone.push_back(i);
  }
  if (!gone.empty()) remove(gone);
  return gone;
}

std::vector<std::size_t> LocalMapGraph::forget_unplaced(std::size_t before_scan) {
  std::vector<std::size_t> gone;
  for (std::size_t first = 0; first < size();) {
    std::size_t end = first + 1;
    while (end < size() && local_maps_[end].run == local_maps_[first].run) ++end;
    const bool has_left = local_maps_[end - 1].last_scan <= before_scan;
    for (; first < end; ++first) {
      if (end < size() && has_left && !located_[first]) gone.push_back(first);
    }
  }
  if (!gone.empty()) remove(gone);
  return gone;
}

void LocalMapGraph::remove(const std::vector<std::size_t>& gone) {
  std::vector<MeasuredEdge> edges = this->edges();
  for (const std::size_t index : gone) marginalize(edges, index);
  std::vector<std::size_t> now(size());  // index after
  std::vector<bool> stays(size(), true);
  for (const std::size_t index : gone) stays[index] = false;
  pose_graph::PoseGraph graph(config_.graph);
  std::size_t count = 0;
  for (std::size_t i = 0; i < size(); ++i) {
    if (!stays[i]) continue;
    now[i] = count++;
    graph.add_node(graph_.pose(i));
    if (now[i] == i) continue;
    local_maps_[now[i]] = std::move(local_maps_[i]);
    clouds_[now[i]] = std::move(clouds_[i]);
    breadths_m_[now[i]] = breadths_m_[i];
    given_[now[i]] = given_[i];
    located_[now[i]] = located_[i];
  }
  local_maps_.resize(count);
  clouds_.resize(count);
  breadths_m_.resize(count);
  given_.resize(count);
  located_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (given_[i]) graph.add_prior({i, given_[i]->mean, given_[i]->covariance.inverse(), false});
  }
  chain_.clear();
  for (MeasuredEdge& measured : edges) {
    measured.edge.from = now[measured.edge.from];
    measured.edge.to = now[measured.edge.to];
    graph.add_edge(measured.edge);
    if (measured.lasting) chain_.push_back(measured.edge);
  }
  graph_ = std::move(graph);
  std::erase_if(cache_, [&](const auto& cached) { return !stays[cached.first]; });
  for (auto& cached : cache_) cached.first = now[cached.first];
}

std::vector<LocalMapGraph::MeasuredEdge> LocalMapGraph::edges() const {
  std::vector<MeasuredEdge> result;
  for (std::size_t i = 0; i < graph_.edges().size(); ++i) {
    if (!graph_.edge_enabled(i)) continue;
    const pose_graph::Edge& edge = graph_.edges()[i];
    const bool lasting = std::any_of(chain_.begin(), chain_.end(), [&](const auto& lasts) {
      return lasts.from == edge.from && lasts.to == edge.to && lasts.robust == edge.robust;
    });
    result.push_back({edge, lasting});
  }
  return result;
}

}  // namespace strata::slam
