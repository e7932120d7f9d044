// SPDX-License-Identifier: Apache-2.0
// Where a later run lies in the map of the earlier ones: the part of LocalMapGraph that searches a
// whole building.
#include <algorithm>
#include <numbers>
#include <optional>

#include "core/registration/correlative_search.hpp"
#include "core/slam/local_map_agreement.hpp"
#include "core/slam/local_map_graph.hpp"

namespace strata::slam {

/// A place found among all poses of a building must fit better than one found near a good guess:
/// most of the run in seen space, free space too (walls alone may fit from the wrong side), and
/// few contradictions either way.
bool LocalMapGraph::run_fits_map(std::size_t first, std::size_t last) const {
  constexpr double kOverlap = 0.6;
  constexpr double kFreeOverlap = 0.6;
  constexpr double kAgreement = 0.8;
  constexpr double kBack = 0.6;
  constexpr std::size_t kPointStride = 3;
  constexpr std::size_t kCellStride = 101;
  const auto state_among = [&](std::size_t begin, std::size_t end, const Eigen::Vector2d& at) {
    SurfaceState state = SurfaceState::kUnknown;
    for (std::size_t i = begin; i < end && state != SurfaceState::kOccupied; ++i) {
      if (begin == 0 && !located_[i]) continue;
      const SurfaceState here = state_near(local_maps_[i].states, inverse(graph_.pose(i)) * at);
      if (here != SurfaceState::kUnknown) state = here;
    }
    return state;
  };
  const auto compare = [&](std::size_t begin, std::size_t end, std::size_t other_begin,
                           std::size_t other_end) {
    std::size_t counts[3] = {0, 0, 0};
    for (std::size_t i = begin; i < end; ++i) {
      if (begin == 0 && !located_[i]) continue;
      for (std::size_t k = 0; k < local_maps_[i].points.size(); k += kPointStride) {
        const registration::SurfacePoint& point = local_maps_[i].points[k];
        const Eigen::Vector2d at = graph_.pose(i) * Eigen::Vector2d(point.x_m, point.y_m);
        ++counts[static_cast<std::size_t>(state_among(other_begin, other_end, at))];
      }
    }
    const std::size_t free = counts[static_cast<std::size_t>(SurfaceState::kFree)];
    const std::size_t surface = counts[static_cast<std::size_t>(SurfaceState::kOccupied)];
    return agreement_of(surface, free, counts[0] + counts[1] + counts[2]);
  };
  std::size_t sampled = 0;
  std::size_t also_free = 0;
  for (std::size_t i = first; i <= last; ++i) {
    const StateGrid& states = local_maps_[i].states;
    for (std::size_t k = 0; k < states.size(); k += kCellStride) {
      if (states.values()[k] != SurfaceState::kFree) continue;
      ++sampled;
      const Eigen::Vector2d at = graph_.pose(i) * states.center(states.cell(k));
      also_free += state_among(0, first, at) == SurfaceState::kFree ? 1 : 0;
    }
  }
  const Agreement forth = compare(first, last + 1, 0, first);
  const Agreement back = compare(0, first, first, last + 1);
  return forth.overlap >= kOverlap && forth.agreement >= kAgreement && back.agreement >= kBack &&
         static_cast<double>(also_free) >= kFreeOverlap * static_cast<double>(sampled);
}

void LocalMapGraph::locate_run(std::size_t last) {
  std::size_t first = last;
  while (first > 0 && local_maps_[first - 1].run == local_maps_[last].run) --first;
  registration::MatchField field(resolution_m_, field_);
  CellRect rect;
  for (std::size_t i = 0; i < first; ++i) {
    if (!located_[i]) continue;
    for (const registration::SurfacePoint& point : local_maps_[i].points) {
      const Eigen::Vector2d at = graph_.pose(i) * Eigen::Vector2d(point.x_m, point.y_m);
      registration::SurfacePoint moved = point;
      moved.x_m = at.x();
      moved.y_m = at.y();
      field.add(moved);
      const Cell cell = cell_at(at, resolution_m_);
      rect = rect.united({cell, {cell.x + 1, cell.y + 1}});
    }
  }
  if (rect.empty()) return;
  // The run so far, seen from its middle.
  const Pose2 middle = local_maps_[first + (last - first) / 2].run_from_local_map;
  Endpoints cloud;
  for (std::size_t i = first; i <= last; ++i) {
    const Pose2 middle_from_local_map = between(middle, local_maps_[i].run_from_local_map);
    for (std::size_t k = 0; k < clouds_[i].size(); ++k) {
      const Eigen::Vector2d at =
          middle_from_local_map * Eigen::Vector2d(clouds_[i].x_m[k], clouds_[i].y_m[k]);
      cloud.x_m.push_back(at.x());
      cloud.y_m.push_back(at.y());
      cloud.beam.push_back(static_cast<std::uint32_t>(cloud.beam.size()));
    }
  }
  const registration::CorrelativeTables tables(field, config_.search);
  const Pose2 guess{0.5 * (rect.min.x + rect.max.x) * resolution_m_,
                    0.5 * (rect.min.y + rect.max.y) * resolution_m_, 0.0};
  const registration::SearchResult found = registration::search(
      subsample(cloud, static_cast<std::size_t>(config_.max_points)), tables, guess,
      {0.5 * rect.width() * resolution_m_, 0.5 * rect.height() * resolution_m_, std::numbers::pi},
      config_.min_score);
  if (!found.found) return;
  const Pose2 map_from_run = found.pose * inverse(middle);
  std::vector<Pose2> before;
  for (std::size_t i = first; i <= last; ++i) {
    before.push_back(graph_.pose(i));
    graph_.set_pose(i, map_from_run * local_maps_[i].run_from_local_map);
  }
  const std::size_t verified = run_fits_map(first, last) ? connect_run(first, last) : 0;
  if (verified == 0) {
    for (std::size_t i = first; i <= last; ++i) graph_.set_pose(i, before[i - first]);
    return;
  }
  for (std::size_t i = first; i <= last; ++i) located_[i] = true;
  optimize();
}

std::size_t LocalMapGraph::connect_run(std::size_t first, std::size_t last) {
  std::size_t verified = 0;
  for (std::size_t i = 0; i < first; ++i) {
    if (!located_[i]) continue;
    std::optional<registration::MatchField> field;
    for (std::size_t k = first; k <= last; ++k) {
      const Pose2 i_from_k = between(graph_.pose(i), graph_.pose(k));
      if (agreement(i, k, i_from_k).overlap < config_.min_overlap) continue;
      if (!field) field = field_of(local_maps_[i], resolution_m_, field_);
      const auto closure = refine(*field, i, k, i_from_k);
      if (!closure) continue;
      add_closure(*closure);
      ++verified;
    }
  }
  return verified;
}

void LocalMapGraph::end_run() {
  if (!local_maps_.empty() && !located_.back()) locate_run(local_maps_.size() - 1);
}

}  // namespace strata::slam
