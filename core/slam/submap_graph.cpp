// SPDX-License-Identifier: Apache-2.0
#include "core/slam/submap_graph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include <Eigen/LU>

#include "core/registration/correlative_search.hpp"
#include "core/registration/scan_matcher.hpp"
#include "core/slam/submap_agreement.hpp"

namespace strata::slam {
namespace {

constexpr std::size_t kCacheSize = 32;
/// Neighbours in a run share scans: what they say of each other is in the chain already.
constexpr std::size_t kSharedScans = 2;
/// A closure whose squared error stays above this (3 degrees of freedom) is wrong.
constexpr double kWrongClosure = 50.0;
/// Closures count as this much path, so that places closed once are searched narrowly later.
constexpr double kClosurePathM = 0.5;

Eigen::Matrix3d symmetric(const Eigen::Matrix3d& matrix) {
  return 0.5 * (matrix + matrix.transpose());
}

Endpoints cloud_of(const Submap& submap, int max_points) {
  Endpoints cloud;
  for (std::size_t i = 0; i < submap.points.size(); ++i) {
    cloud.x_m.push_back(submap.points[i].x_m);
    cloud.y_m.push_back(submap.points[i].y_m);
    cloud.beam.push_back(static_cast<std::uint32_t>(i));
  }
  return thin(cloud, static_cast<std::size_t>(max_points));
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
  if (given) graph_.add_prior({index, given->mean, given->covariance.inverse(), false});
  if (continues) {
    pose_graph::Edge edge;
    edge.from = index - 1;
    edge.to = index;
    edge.from_from_to = between(submaps_.back().run_from_submap, submap.run_from_submap);
    const double length_m = std::hypot(edge.from_from_to.x, edge.from_from_to.y);
    const double sigma_m = config_.chain_floor_m + config_.chain_per_metre_m * length_m;
    const double sigma_rad = config_.chain_floor_rad + config_.chain_per_metre_rad * length_m;
    // Where the matches were ambiguous (along a bare corridor) the chain gives way.
    Eigen::Matrix3d covariance = submap.from_previous;
    covariance.diagonal() +=
        Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad);
    edge.information = symmetric(covariance.inverse());
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
  edge.information = symmetric(closure.a_from_b.covariance.inverse());
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
    if (given_[i]) graph.add_prior({i, given_[i]->mean, given_[i]->covariance.inverse(), false});
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
