// SPDX-License-Identifier: Apache-2.0
// Which local maps see the same place, and how they lie on each other: the part of LocalMapGraph
// that finds loop closures.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "core/registration/correlative_search.hpp"
#include "core/registration/scan_matcher.hpp"
#include "core/slam/local_map_agreement.hpp"
#include "core/slam/local_map_graph.hpp"

namespace strata::slam {
namespace {

/// What is kept of the local maps that were searched last; one alone may be larger. More would save
/// little: along a way the same few are candidates again and again.
constexpr std::size_t kCache_bytes = 24'000'000;
/// Local maps whose middles lie so far apart may see the same place; in halls and outdoors, where
/// each sees farther to all sides, as far as the broader of them does. Not where poses that came
/// with the log hold both: those tell of far places more than what is seen from afar.
constexpr double kApartM = 4.0;
/// The same where the poses are good and only the overlap decides: as far as both see.
constexpr double kApartTightM = 8.0;

/// Neighbours in a run share scans: what they say of each other is in the chain already.
constexpr std::size_t kSharedScans = 2;

/// Those end points that lie in space which `seen` knows. Others match nothing that is there, but
/// where the view of a wall ends, the few hits at its edge go on as a line of uncertain direction:
/// on the way back along a corridor they drew the robot 0.1 m into what the way out had seen.
Endpoints in_seen_space(const Endpoints& endpoints, const Pose2& seen_from_points,
                        const StateGrid& seen) {
  return those_of(endpoints, [&](std::size_t i) {
    return state_near(seen, seen_from_points * endpoints.point_m(i)) != SurfaceState::kUnknown;
  });
}

}  // namespace

struct LocalMapGraph::Searchable {
  registration::MatchField field;
  registration::CorrelativeTables tables;
  Searchable(registration::MatchField match_field, const registration::CorrelativeConfig& config)
      : field(std::move(match_field)), tables(field, config) {}
  /// About so much: tables of coarser levels are a little wider.
  [[nodiscard]] std::size_t bytes() const {
    const std::size_t levels = static_cast<std::size_t>(tables.depth()) + 1;
    return field.points().size() * sizeof(registration::SurfacePoint) +
           field.nearest_points().size() * sizeof(std::int32_t) + levels * tables.rect().area();
  }
};

std::shared_ptr<const LocalMapGraph::Searchable> LocalMapGraph::searchable(std::size_t index) {
  const auto known = std::find_if(cache_.begin(), cache_.end(),
                                  [&](const auto& cached) { return cached.first == index; });
  if (known != cache_.end()) {
    std::rotate(known, known + 1, cache_.end());  // the one used last is the last
    return cache_.back().second;
  }
  auto value = std::make_shared<const Searchable>(
      field_of(local_maps_[index], resolution_m_, field_), config_.search);
  cache_.emplace_back(index, value);
  std::size_t bytes = 0;
  for (const auto& cached : cache_) bytes += cached.second->bytes();
  while (bytes > kCache_bytes && cache_.size() > 1) {
    bytes -= cache_.front().second->bytes();
    cache_.erase(cache_.begin());
  }
  return value;
}

std::optional<LocalMapGraph::Closure> LocalMapGraph::refine(const registration::MatchField& field,
                                                            std::size_t a, std::size_t b,
                                                            const Pose2& guess) const {
  const Endpoints comparable = in_seen_space(clouds_[b], guess, local_maps_[a].states);
  const registration::MatchResult result =
      registration::match(comparable, {}, field, guess, nullptr, match_);
  if (!result.converged) return std::nullopt;
  const Agreement forth = agreement(a, b, result.pose);
  const Agreement back = agreement(b, a, inverse(result.pose));
  const bool agrees = std::min(forth.agreement, back.agreement) >= config_.min_agreement &&
                      std::max(forth.overlap, back.overlap) >= config_.min_overlap &&
                      std::min(forth.overlap, back.overlap) >= 0.5 * config_.min_overlap;
  if (!agrees) return std::nullopt;
  Closure closure{a, b, {result.pose, result.covariance}};
  closure.a_from_b.covariance.diagonal() +=
      pose_covariance(config_.stddev_m, config_.stddev_rad).diagonal();
  return closure;
}

std::optional<LocalMapGraph::Closure> LocalMapGraph::try_closure(std::size_t a, std::size_t b,
                                                                 const Pose2& guess,
                                                                 double window_m,
                                                                 double window_rad) {
  const std::shared_ptr<const Searchable> target = searchable(a);
  // The window turns about the origin of b, where its points are not: search about their middle.
  const registration::SearchResult found = registration::search(
      clouds_[b], target->tables, guess, {window_m, window_m, window_rad}, config_.min_score);
  if (!found.found) return std::nullopt;
  return refine(target->field, a, b, found.pose);
}

void LocalMapGraph::search_closures(std::size_t index) {
  struct Candidate {
    std::size_t local_map;
    double distance_m;
    double window_m;
    double window_rad;
  };
  const bool settled = is_settled(index);
  const std::vector<double> lengths = path_lengths(index);
  const Eigen::Vector2d center = graph_.pose(index) * local_maps_[index].center_m;
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < index; ++i) {
    const bool shares = local_maps_[i].run == local_maps_[index].run && index - i <= kSharedScans;
    if (shares || !located_[i] || local_maps_[i].points.empty()) continue;
    if (settled && is_settled(i)) continue;
    double length_m = lengths[i];
    if (given_[i] && given_[index]) length_m = std::min(length_m, 10.0);
    const double window_m =
        std::min(config_.max_window_m, config_.floor_window_m + config_.drift_m_per_m * length_m);
    const double window_rad = std::min(
        config_.max_window_rad, config_.floor_window_rad + config_.drift_rad_per_m * length_m);
    const Eigen::Vector2d other = graph_.pose(i) * local_maps_[i].center_m;
    const double distance_m = (other - center).norm();
    const bool held = given_[i] && given_[index];
    const double apart_m = held ? kApartM : std::max({kApartM, breadths_m_[index], breadths_m_[i]});
    if (distance_m > apart_m + window_m) continue;
    candidates.push_back({i, distance_m, window_m, window_rad});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.distance_m != b.distance_m ? a.distance_m < b.distance_m : a.local_map < b.local_map;
  });
  if (candidates.size() > static_cast<std::size_t>(config_.max_attempts)) {
    candidates.resize(static_cast<std::size_t>(config_.max_attempts));
  }
  bool changed = false;
  for (const Candidate& candidate : candidates) {
    const Pose2 guess = between(graph_.pose(candidate.local_map), graph_.pose(index));
    const auto closure =
        try_closure(candidate.local_map, index, guess, candidate.window_m, candidate.window_rad);
    if (!closure) continue;
    add_closure(*closure);
    changed = true;
  }
  if (changed) optimize();
}

void LocalMapGraph::tighten(int rounds, Progress* progress) {
  if (!config_.enabled) return;
  constexpr std::size_t kPartners = 8;
  for (int round = 0; round < rounds; ++round) {
    report_progress(progress, "match local maps", static_cast<std::size_t>(round),
                    static_cast<std::size_t>(rounds));
    std::vector<std::vector<Closure>> found(size());
    pool_.for_chunks(size(), 1, [&](std::size_t begin, std::size_t, std::size_t) {
      const std::size_t a = begin;
      if (!located_[a] || local_maps_[a].points.empty()) return;
      const bool settled = is_settled(a);
      std::vector<std::pair<double, std::size_t>> partners;
      for (std::size_t b = a + 1; b < size(); ++b) {
        const bool shares = local_maps_[a].run == local_maps_[b].run && b - a <= kSharedScans;
        if (shares || !located_[b] || local_maps_[b].points.empty()) continue;
        if (settled && is_settled(b)) continue;
        const Eigen::Vector2d apart =
            graph_.pose(a) * local_maps_[a].center_m - graph_.pose(b) * local_maps_[b].center_m;
        const bool held = given_[a] && given_[b];
        const double both_m = held ? 0.0 : breadths_m_[a] + breadths_m_[b];
        if (apart.norm() > std::max(kApartTightM, both_m)) continue;
        const double overlap = agreement(a, b, between(graph_.pose(a), graph_.pose(b))).overlap;
        if (overlap >= config_.min_overlap) partners.emplace_back(-overlap, b);
      }
      if (partners.empty()) return;
      std::sort(partners.begin(), partners.end());
      if (partners.size() > kPartners) partners.resize(kPartners);
      const registration::MatchField field = field_of(local_maps_[a], resolution_m_, field_);
      for (const auto& [unused, b] : partners) {
        const auto closure = refine(field, a, b, between(graph_.pose(a), graph_.pose(b)));
        if (closure) found[a].push_back(*closure);
      }
    });
    std::vector<Closure> closures;
    for (const auto& some : found) closures.insert(closures.end(), some.begin(), some.end());
    rebuild_graph(closures);
  }
}

}  // namespace strata::slam
