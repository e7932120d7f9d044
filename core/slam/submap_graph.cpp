// SPDX-License-Identifier: Apache-2.0
#include "core/slam/submap_graph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

#include <Eigen/LU>

#include "core/registration/correlative_search.hpp"
#include "core/registration/scan_matcher.hpp"

namespace strata::slam {
namespace {

constexpr std::size_t kCacheSize = 32;
/// Neighbours in a run share scans: what they say of each other is in the chain already.
constexpr std::size_t kSharedScans = 2;
/// A closure whose squared error stays above this (3 degrees of freedom) is wrong.
constexpr double kWrongClosure = 50.0;
/// Closures count as this much path, so that places closed once are searched narrowly later.
constexpr double kClosurePathM = 0.5;

Endpoints cloud_of(const Submap& submap, int max_points) {
  Endpoints cloud;
  for (std::size_t i = 0; i < submap.points.size(); ++i) {
    cloud.x_m.push_back(submap.points[i].x_m);
    cloud.y_m.push_back(submap.points[i].y_m);
    cloud.beam.push_back(static_cast<std::uint32_t>(i));
  }
  return thin(cloud, static_cast<std::size_t>(max_points));
}

registration::MatchField field_of(const Submap& submap, double resolution_m,
                                  const registration::MatchFieldConfig& config) {
  registration::MatchField field(resolution_m, config);
  for (const registration::SurfacePoint& point : submap.points) field.add(point);
  return field;
}

/// What the 3 x 3 cells about a point say: occupied when one of them is.
SurfaceState state_near(const StateGrid& states, const Eigen::Vector2d& point_m) {
  const Cell cell = states.cell_at(point_m);
  const SurfaceState own = states.get(cell);
  if (own == SurfaceState::kUnknown) return own;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (states.get({cell.x + dx, cell.y + dy}) == SurfaceState::kOccupied) {
        return SurfaceState::kOccupied;
      }
    }
  }
  return own;
}

Agreement agreement_of(std::size_t surface, std::size_t free, std::size_t all) {
  const std::size_t seen = surface + free;
  if (seen == 0) return {};
  return {static_cast<double>(seen) / static_cast<double>(all),
          static_cast<double>(surface) / static_cast<double>(seen)};
}

}  // namespace

struct SubmapGraph::Searchable {
  registration::MatchField field;
  registration::CorrelativeTables tables;
  Searchable(registration::MatchField match_field, const registration::CorrelativeConfig& config)
      : field(std::move(match_field)), tables(field, config) {}
};

SubmapGraph::SubmapGraph(const ClosureConfig& config, const registration::MatchConfig& match,
                         const registration::MatchFieldConfig& field, double resolution_m,
                         WorkerPool& pool)
    : config_(config),
      match_(match),
      field_(field),
      resolution_m_(resolution_m),
      pool_(pool),
      graph_(config.graph) {}

SubmapGraph::~SubmapGraph() = default;

std::shared_ptr<const SubmapGraph::Searchable> SubmapGraph::searchable(std::size_t index) {
  for (const auto& [cached, value] : cache_) {
    if (cached == index) return value;
  }
  auto value = std::make_shared<const Searchable>(field_of(submaps_[index], resolution_m_, field_),
                                                  config_.search);
  if (cache_.size() >= kCacheSize) cache_.erase(cache_.begin());
  cache_.emplace_back(index, value);
  return value;
}

std::size_t SubmapGraph::add(Submap submap, const std::optional<Pose2Gaussian>& given) {
  const std::size_t index = submaps_.size();
  const bool continues = index > 0 && submaps_.back().run == submap.run;
  Pose2 pose = submap.run_from_submap;
  if (given) {
    pose = given->mean;
  } else if (continues) {
    pose = map_from_run(index - 1) * submap.run_from_submap;
  }
  graph_.add_node(pose);
  if (given) graph_.add_prior({index, given->mean, given->covariance.inverse(), true});
  if (continues) {
    pose_graph::Edge edge;
    edge.from = index - 1;
    edge.to = index;
    edge.from_from_to = between(submaps_.back().run_from_submap, submap.run_from_submap);
    const double length_m = std::hypot(edge.from_from_to.x, edge.from_from_to.y);
    const double sigma_m = config_.chain_floor_m + config_.chain_per_metre_m * length_m;
    const double sigma_rad = config_.chain_floor_rad + config_.chain_per_metre_rad * length_m;
    edge.information = Eigen::Vector3d(1.0 / (sigma_m * sigma_m), 1.0 / (sigma_m * sigma_m),
                                       1.0 / (sigma_rad * sigma_rad))
                           .asDiagonal();
    graph_.add_edge(edge);
    chain_.push_back(edge);
  }
  located_.push_back(given.has_value() || (continues ? located_.back() : index == 0));
  clouds_.push_back(cloud_of(submap, config_.max_points));
  given_.push_back(given);
  submaps_.push_back(std::move(submap));
  if (!located_[index]) {
    // The longer the run, the less can it be mistaken; each try costs as much as all before.
    std::size_t length = 1;
    while (length <= index && submaps_[index - length].run == submaps_[index].run) ++length;
    if ((length & (length - 1)) == 0) locate_run(index);
  }
  if (config_.enabled && located_[index]) search_closures(index);
  return index;
}

Agreement SubmapGraph::agreement(std::size_t a, std::size_t b, const Pose2& a_from_b) const {
  std::size_t surface = 0;
  std::size_t free = 0;
  for (const registration::SurfacePoint& point : submaps_[b].points) {
    const SurfaceState state =
        state_near(submaps_[a].states, a_from_b * Eigen::Vector2d(point.x_m, point.y_m));
    surface += state == SurfaceState::kOccupied ? 1 : 0;
    free += state == SurfaceState::kFree ? 1 : 0;
  }
  return agreement_of(surface, free, submaps_[b].points.size());
}

/// A place found among all poses of a building must fit better than one found near a good guess:
/// most of the run in seen space, free space too (walls alone may fit from the wrong side), and
/// few contradictions either way.
bool SubmapGraph::run_fits_map(std::size_t first, std::size_t last) const {
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
      const SurfaceState here = state_near(submaps_[i].states, inverse(graph_.pose(i)) * at);
      if (here != SurfaceState::kUnknown) state = here;
    }
    return state;
  };
  const auto compare = [&](std::size_t begin, std::size_t end, std::size_t other_begin,
                           std::size_t other_end) {
    std::size_t counts[3] = {0, 0, 0};
    for (std::size_t i = begin; i < end; ++i) {
      if (begin == 0 && !located_[i]) continue;
      for (std::size_t k = 0; k < submaps_[i].points.size(); k += kPointStride) {
        const registration::SurfacePoint& point = submaps_[i].points[k];
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
    const StateGrid& states = submaps_[i].states;
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

std::vector<double> SubmapGraph::path_lengths(std::size_t from) const {
  std::vector<std::vector<std::pair<std::size_t, double>>> links(submaps_.size());
  for (std::size_t i = 0; i < graph_.edges().size(); ++i) {
    if (!graph_.edge_enabled(i)) continue;
    const pose_graph::Edge& edge = graph_.edges()[i];
    const double length_m =
        edge.robust ? kClosurePathM : std::hypot(edge.from_from_to.x, edge.from_from_to.y);
    links[edge.from].emplace_back(edge.to, length_m);
    links[edge.to].emplace_back(edge.from, length_m);
  }
  std::vector<double> lengths(submaps_.size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  lengths[from] = 0.0;
  open.emplace(0.0, from);
  while (!open.empty()) {
    const auto [length, node] = open.top();
    open.pop();
    if (length > lengths[node]) continue;
    for (const auto& [next, more] : links[node]) {
      if (length + more >= lengths[next]) continue;
      lengths[next] = length + more;
      open.emplace(lengths[next], next);
    }
  }
  return lengths;
}

std::optional<SubmapGraph::Closure> SubmapGraph::refine(const registration::MatchField& field,
                                                        std::size_t a, std::size_t b,
                                                        const Pose2& guess) const {
  const registration::MatchResult result =
      registration::match(clouds_[b], {}, field, guess, nullptr, match_);
  if (!result.converged) return std::nullopt;
  const Agreement forth = agreement(a, b, result.pose);
  const Agreement back = agreement(b, a, inverse(result.pose));
  const bool agrees = std::min(forth.agreement, back.agreement) >= config_.min_agreement &&
                      std::max(forth.overlap, back.overlap) >= config_.min_overlap &&
                      std::min(forth.overlap, back.overlap) >= 0.5 * config_.min_overlap;
  if (!agrees) return std::nullopt;
  Closure closure{a, b, {result.pose, result.covariance}};
  closure.a_from_b.covariance.diagonal() +=
      Eigen::Vector3d(config_.stddev_m * config_.stddev_m, config_.stddev_m * config_.stddev_m,
                      config_.stddev_rad * config_.stddev_rad);
  return closure;
}

std::optional<SubmapGraph::Closure> SubmapGraph::try_closure(std::size_t a, std::size_t b,
                                                             const Pose2& guess, double window_m,
                                                             double window_rad) {
  const std::shared_ptr<const Searchable> target = searchable(a);
  // The window turns about the origin of b, where its points are not: search about their middle.
  const registration::SearchResult found = registration::search(
      clouds_[b], target->tables, guess, {window_m, window_m, window_rad}, config_.min_score);
  if (!found.found) return std::nullopt;
  return refine(target->field, a, b, found.pose);
}

void SubmapGraph::add_closure(const Closure& closure) {
  pose_graph::Edge edge;
  edge.from = closure.a;
  edge.to = closure.b;
  edge.from_from_to = closure.a_from_b.mean;
  const Eigen::Matrix3d information = closure.a_from_b.covariance.inverse();
  edge.information = 0.5 * (information + information.transpose());
  edge.robust = true;
  graph_.add_edge(edge);
}

void SubmapGraph::search_closures(std::size_t index) {
  struct Candidate {
    std::size_t submap;
    double distance_m;
    double window_m;
    double window_rad;
  };
  const std::vector<double> lengths = path_lengths(index);
  const Eigen::Vector2d center = graph_.pose(index) * submaps_[index].center_m;
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < index; ++i) {
    const bool shares = submaps_[i].run == submaps_[index].run && index - i <= kSharedScans;
    if (shares || !located_[i] || submaps_[i].points.empty()) continue;
    double length_m = lengths[i];
    if (given_[i] && given_[index]) length_m = std::min(length_m, 10.0);
    const double window_m =
        std::min(config_.max_window_m, config_.floor_window_m + config_.drift_m_per_m * length_m);
    const double window_rad = std::min(
        config_.max_window_rad, config_.floor_window_rad + config_.drift_rad_per_m * length_m);
    const Eigen::Vector2d other = graph_.pose(i) * submaps_[i].center_m;
    const double distance_m = (other - center).norm();
    if (distance_m > 4.0 + window_m) continue;
    candidates.push_back({i, distance_m, window_m, window_rad});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.distance_m != b.distance_m ? a.distance_m < b.distance_m : a.submap < b.submap;
  });
  if (candidates.size() > static_cast<std::size_t>(config_.max_attempts)) {
    candidates.resize(static_cast<std::size_t>(config_.max_attempts));
  }
  bool changed = false;
  for (const Candidate& candidate : candidates) {
    const Pose2 guess = between(graph_.pose(candidate.submap), graph_.pose(index));
    const auto closure =
        try_closure(candidate.submap, index, guess, candidate.window_m, candidate.window_rad);
    if (!closure) continue;
    add_closure(*closure);
    changed = true;
  }
  if (changed) optimize();
}

void SubmapGraph::optimize() {
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

void SubmapGraph::locate_run(std::size_t last) {
  std::size_t first = last;
  while (first > 0 && submaps_[first - 1].run == submaps_[last].run) --first;
  registration::MatchField field(resolution_m_, field_);
  CellRect rect;
  for (std::size_t i = 0; i < first; ++i) {
    if (!located_[i]) continue;
    for (const registration::SurfacePoint& point : submaps_[i].points) {
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
  const Pose2 middle = submaps_[first + (last - first) / 2].run_from_submap;
  Endpoints cloud;
  for (std::size_t i = first; i <= last; ++i) {
    const Pose2 middle_from_submap = between(middle, submaps_[i].run_from_submap);
    for (std::size_t k = 0; k < clouds_[i].size(); ++k) {
      const Eigen::Vector2d at =
          middle_from_submap * Eigen::Vector2d(clouds_[i].x_m[k], clouds_[i].y_m[k]);
      cloud.x_m.push_back(at.x());
      cloud.y_m.push_back(at.y());
      cloud.beam.push_back(static_cast<std::uint32_t>(cloud.beam.size()));
    }
  }
  const registration::CorrelativeTables tables(field, config_.search);
  const Pose2 guess{0.5 * (rect.min.x + rect.max.x) * resolution_m_,
                    0.5 * (rect.min.y + rect.max.y) * resolution_m_, 0.0};
  const registration::SearchResult found = registration::search(
      thin(cloud, static_cast<std::size_t>(config_.max_points)), tables, guess,
      {0.5 * rect.width() * resolution_m_, 0.5 * rect.height() * resolution_m_, std::numbers::pi},
      config_.min_score);
  if (!found.found) return;
  const Pose2 map_from_run = found.pose * inverse(middle);
  std::vector<Pose2> before;
  for (std::size_t i = first; i <= last; ++i) {
    before.push_back(graph_.pose(i));
    graph_.set_pose(i, map_from_run * submaps_[i].run_from_submap);
  }
  const std::size_t verified = run_fits_map(first, last) ? tie_run(first, last) : 0;
  if (verified == 0) {
    for (std::size_t i = first; i <= last; ++i) graph_.set_pose(i, before[i - first]);
    return;
  }
  for (std::size_t i = first; i <= last; ++i) located_[i] = true;
  optimize();
}

std::size_t SubmapGraph::tie_run(std::size_t first, std::size_t last) {
  std::size_t verified = 0;
  for (std::size_t i = 0; i < first; ++i) {
    if (!located_[i]) continue;
    std::optional<registration::MatchField> field;
    for (std::size_t k = first; k <= last; ++k) {
      const Pose2 i_from_k = between(graph_.pose(i), graph_.pose(k));
      if (agreement(i, k, i_from_k).overlap < config_.min_overlap) continue;
      if (!field) field = field_of(submaps_[i], resolution_m_, field_);
      const auto closure = refine(*field, i, k, i_from_k);
      if (!closure) continue;
      add_closure(*closure);
      ++verified;
    }
  }
  return verified;
}

void SubmapGraph::end_run() {
  if (!submaps_.empty() && !located_.back()) locate_run(submaps_.size() - 1);
}

std::size_t SubmapGraph::closures() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < graph_.edges().size(); ++i) {
    if (graph_.edges()[i].robust && graph_.edge_enabled(i)) ++count;
  }
  return count;
}

void SubmapGraph::rebuild_graph(const std::vector<Closure>& closures) {
  pose_graph::PoseGraph graph(config_.graph);
  for (std::size_t i = 0; i < size(); ++i) {
    graph.add_node(graph_.pose(i));
    if (given_[i]) graph.add_prior({i, given_[i]->mean, given_[i]->covariance.inverse(), true});
  }
  for (const pose_graph::Edge& edge : chain_) graph.add_edge(edge);
  graph_ = std::move(graph);
  for (const Closure& closure : closures) add_closure(closure);
  optimize();
}

void SubmapGraph::tighten(int rounds, Progress* progress) {
  if (!config_.enabled) return;
  constexpr std::size_t kPartners = 8;
  for (int round = 0; round < rounds; ++round) {
    report_progress(progress, "tie sub-maps", static_cast<std::size_t>(round),
                    static_cast<std::size_t>(rounds));
    std::vector<std::vector<Closure>> found(size());
    pool_.for_chunks(size(), 1, [&](std::size_t begin, std::size_t, std::size_t) {
      const std::size_t a = begin;
      if (!located_[a] || submaps_[a].points.empty()) return;
      std::vector<std::pair<double, std::size_t>> partners;
      for (std::size_t b = a + 1; b < size(); ++b) {
        const bool shares = submaps_[a].run == submaps_[b].run && b - a <= kSharedScans;
        if (shares || !located_[b] || submaps_[b].points.empty()) continue;
        const Eigen::Vector2d apart =
            graph_.pose(a) * submaps_[a].center_m - graph_.pose(b) * submaps_[b].center_m;
        if (apart.norm() > 8.0) continue;
        const double overlap = agreement(a, b, between(graph_.pose(a), graph_.pose(b))).overlap;
        if (overlap >= config_.min_overlap) partners.emplace_back(-overlap, b);
      }
      if (partners.empty()) return;
      std::sort(partners.begin(), partners.end());
      if (partners.size() > kPartners) partners.resize(kPartners);
      const registration::MatchField field = field_of(submaps_[a], resolution_m_, field_);
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
