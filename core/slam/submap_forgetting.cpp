// SPDX-License-Identifier: Apache-2.0
// Which sub-maps later ones have made superfluous, and how the graph does without them.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "core/slam/submap_graph.hpp"

namespace strata::slam {
namespace {

/// The latest sub-maps of a run share scans, and the next one is tied to them.
constexpr std::size_t kLatest = 4;
/// Cells that are looked at: every so manieth, a number that divides no usual width.
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

/// Takes `node` out: its neighbours are tied to the one that it is tied to most firmly, by both
/// measurements one after the other. With two neighbours that is what marginalizing gives; with
/// more, what they say of each other by way of the node is told by way of that neighbour alone.
void SubmapGraph::bridge(std::vector<Tie>& ties, std::size_t node) {
  std::vector<Tie> own;
  const auto rest = std::stable_partition(ties.begin(), ties.end(), [&](const Tie& tie) {
    return tie.edge.from != node && tie.edge.to != node;
  });
  own.assign(rest, ties.end());
  ties.erase(rest, ties.end());
  if (own.size() < 2) return;
  const auto firmest = std::min_element(own.begin(), own.end(), [&](const Tie& a, const Tie& b) {
    return seen_from(a.edge, node).covariance.trace() < seen_from(b.edge, node).covariance.trace();
  });
  const std::size_t hub = other_end(firmest->edge, node);
  const Pose2Gaussian hub_from_node = inverse(seen_from(firmest->edge, node));
  for (const Tie& tie : own) {
    const std::size_t other = other_end(tie.edge, node);
    const bool known = other == hub || std::any_of(ties.begin(), ties.end(), [&](const auto& some) {
                         return joins(some.edge, hub, other);
                       });
    if (known) continue;
    const Pose2Gaussian across = hub_from_node * seen_from(tie.edge, node);
    Tie bridged;
    bridged.edge.from = hub;
    bridged.edge.to = other;
    bridged.edge.from_from_to = across.mean;
    const Eigen::Matrix3d information = across.covariance.inverse();
    bridged.edge.information = 0.5 * (information + information.transpose());
    bridged.edge.robust = tie.edge.robust || firmest->edge.robust;
    bridged.lasting = true;
    ties.push_back(bridged);
  }
}

bool SubmapGraph::is_superfluous(std::size_t index, const KeepConfig& keep) const {
  const Submap& submap = submaps_[index];
  if (submap.points.empty()) return true;
  std::size_t known = 0;
  std::size_t own = 0;
  for (std::size_t k = 0; k < submap.states.size(); k += kStride) {
    if (submap.states.values()[k] == SurfaceState::kUnknown) continue;
    ++known;
    const Eigen::Vector2d at = graph_.pose(index) * submap.states.center(submap.states.cell(k));
    int views = 0;
    for (std::size_t later = size() - 1; later > index && views < keep.views; --later) {
      if (!same_frame(index, later)) continue;
      const Eigen::Vector2d there = inverse(graph_.pose(later)) * at;
      const StateGrid& states = submaps_[later].states;
      views += states.get(states.cell_at(there)) != SurfaceState::kUnknown ? 1 : 0;
    }
    own += views < keep.views ? 1 : 0;
  }
  return static_cast<double>(own) < keep.own_share * static_cast<double>(known);
}

std::vector<std::size_t> SubmapGraph::forget(const KeepConfig& keep, std::size_t before_scan) {
  std::vector<std::size_t> gone;
  if (size() <= kLatest) return gone;
  const CellRect& newest = submaps_.back().states.rect();
  const double reach_m = resolution_m_ * std::hypot(newest.width(), newest.height());
  const Eigen::Vector2d center = graph_.pose(size() - 1) * submaps_.back().center_m;
  for (std::size_t i = 0; i + kLatest < size(); ++i) {
    if (!same_frame(i, size() - 1) || submaps_[i].last_scan > before_scan) continue;
    // Only where the newest one sees can an older one have become superfluous.
    const CellRect& rect = submaps_[i].states.rect();
    const double both_m = reach_m + resolution_m_ * std::hypot(rect.width(), rect.height());
    if ((graph_.pose(i) * submaps_[i].center_m - center).norm() > both_m) continue;
    if (is_superfluous(i, keep)) gone.push_back(i);
  }
  if (!gone.empty()) remove(gone);
  return gone;
}

void SubmapGraph::remove(const std::vector<std::size_t>& gone) {
  std::vector<Tie> ties = this->ties();
  for (const std::size_t index : gone) bridge(ties, index);
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
    submaps_[now[i]] = std::move(submaps_[i]);
    clouds_[now[i]] = std::move(clouds_[i]);
    given_[now[i]] = given_[i];
    located_[now[i]] = located_[i];
  }
  submaps_.resize(count);
  clouds_.resize(count);
  given_.resize(count);
  located_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (given_[i]) graph.add_prior({i, given_[i]->mean, given_[i]->covariance.inverse(), false});
  }
  chain_.clear();
  for (Tie& tie : ties) {
    tie.edge.from = now[tie.edge.from];
    tie.edge.to = now[tie.edge.to];
    graph.add_edge(tie.edge);
    if (tie.lasting) chain_.push_back(tie.edge);
  }
  graph_ = std::move(graph);
  std::erase_if(cache_, [&](const auto& cached) { return !stays[cached.first]; });
  for (auto& cached : cache_) cached.first = now[cached.first];
}

std::vector<SubmapGraph::Tie> SubmapGraph::ties() const {
  std::vector<Tie> result;
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
