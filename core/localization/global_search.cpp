// SPDX-License-Identifier: Apache-2.0
#include "core/localization/global_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.hpp"
#include "core/grid/floor_divide.hpp"

namespace strata::localization {
namespace {

/// Of the end points, this share lies nearer than the one that a heading moves by one square.
constexpr double kNearShare = 0.8;
constexpr double kMinTurn_rad = 0.0087;
constexpr double kMaxTurn_rad = 0.07;
constexpr double kMaxDistance_m = 2.0;

bool better(const GlobalSearch::LatticePlace& a, const GlobalSearch::LatticePlace& b) {
  if (a.steps != b.steps) return a.steps > b.steps;
  if (a.heading != b.heading) return a.heading < b.heading;
  if (a.square.y != b.square.y) return a.square.y < b.square.y;
  return a.square.x < b.square.x;
}

}  // namespace

struct GlobalSearch::Lattice {
  int headings = 0;
  std::size_t points = 0;
  std::vector<CellOffset> offsets;  // heading by heading
  [[nodiscard]] std::span<const CellOffset> of(int heading) const {
    return {offsets.data() + static_cast<std::size_t>(heading) * points, points};
  }
};

/// Blocks that may hold a candidate, as places of their least corner with their bound.
struct GlobalSearch::Blocks {
  std::vector<LatticePlace> places;
  std::uint32_t best = 0;  // score of a place
};

GlobalSearch::GlobalSearch(const ReflectionGrid& map, const GlobalSearchConfig& config)
    : config_(config),
      field_(map, {config.hit_weight, config.hit_stddev_m,
                   std::min(kMaxDistance_m, 5.0 * config.hit_stddev_m)}) {
  require_valid(config, "global_search");
  const int cells =
      std::max(1, static_cast<int>(std::lround(config.resolution_m / map.resolution_m())));
  side_m_ = cells * map.resolution_m();
  const CellRect& rect = map.rect();
  if (rect.empty()) return;
  corner_ = {floor_divide(rect.min.x, cells), floor_divide(rect.min.y, cells)};
  squares_x_ = floor_divide(rect.max.x - 1, cells) - corner_.x + 1;
  squares_y_ = floor_divide(rect.max.y - 1, cells) - corner_.y + 1;
  const auto width = static_cast<std::size_t>(squares_x_);
  least_ = std::log(1.0 - config.hit_weight);
  const double scale = 255.0 / -least_;
  Grid<std::uint8_t> scores(side_m_, {corner_, {corner_.x + squares_x_, corner_.y + squares_y_}},
                            0);
  open_.assign(scores.size(), 0);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Cell cell = map.cell(i);
    const std::size_t square =
        scores.index({floor_divide(cell.x, cells), floor_divide(cell.y, cells)});
    const double nats = static_cast<double>(field_.log_likelihood().values()[i]) - least_;
    const auto steps = static_cast<std::uint8_t>(std::lround(std::clamp(nats * scale, 0.0, 255.0)));
    scores.values()[square] = std::max(scores.values()[square], steps);
    if (is_free(map.values()[i])) open_[square] = 1;
  }
  bounds_.emplace_back(scores, config.levels);
  const BlockBounds& bounds = bounds_.front();
  const auto blocks_x = static_cast<std::size_t>(bounds.blocks_x());
  open_blocks_.assign(static_cast<std::size_t>(bounds.blocks_y()), {bounds.blocks_x(), 0});
  open_block_.assign(blocks_x * static_cast<std::size_t>(bounds.blocks_y()), 0);
  for (std::size_t i = 0; i < open_.size(); ++i) {
    if (open_[i] == 0) continue;
    const auto x = static_cast<int>(i % width) / bounds.side();
    const auto y = i / width / static_cast<std::size_t>(bounds.side());
    open_blocks_[y].begin = std::min(open_blocks_[y].begin, x);
    open_blocks_[y].end = std::max(open_blocks_[y].end, x + 1);
    open_block_[y * blocks_x + static_cast<std::size_t>(x)] = 1;
  }
}

bool GlobalSearch::is_open(const Cell& square) const {
  if (square.x < 0 || square.y < 0 || square.x >= squares_x_ || square.y >= squares_y_)
    return false;
  return open_[static_cast<std::size_t>(square.y) * static_cast<std::size_t>(squares_x_) +
               static_cast<std::size_t>(square.x)] != 0;
}

int GlobalSearch::headings(const Endpoints& endpoints) const {
  std::vector<double> ranges_m;
  for (std::size_t i = 0; i < endpoints.size(); ++i) {
    ranges_m.push_back(std::hypot(endpoints.x_m[i], endpoints.y_m[i]));
  }
  const auto place =
      static_cast<std::size_t>(kNearShare * static_cast<double>(ranges_m.size() - 1));
  std::nth_element(ranges_m.begin(), ranges_m.begin() + static_cast<std::ptrdiff_t>(place),
                   ranges_m.end());
  const double turn =
      std::clamp(side_m_ / std::max(ranges_m[place], side_m_), kMinTurn_rad, kMaxTurn_rad);
  return static_cast<int>(std::ceil(2.0 * std::numbers::pi / turn));
}

GlobalSearch::Lattice GlobalSearch::make_lattice(const Endpoints& endpoints) const {
  Lattice lattice;
  lattice.headings = headings(endpoints);
  lattice.points = endpoints.size();
  lattice.offsets.reserve(lattice.points * static_cast<std::size_t>(lattice.headings));
  for (int heading = 0; heading < lattice.headings; ++heading) {
    const double theta = pose_of({heading, {}, 0}, lattice.headings).theta;
    const double c = std::cos(theta) / side_m_;
    const double s = std::sin(theta) / side_m_;
    for (std::size_t i = 0; i < endpoints.size(); ++i) {
      const double x = 0.5 + c * endpoints.x_m[i] - s * endpoints.y_m[i];
      const double y = 0.5 + s * endpoints.x_m[i] + c * endpoints.y_m[i];
      lattice.offsets.push_back(
          {static_cast<std::int32_t>(std::floor(x)), static_cast<std::int32_t>(std::floor(y))});
    }
  }
  return lattice;
}

Pose2 GlobalSearch::pose_of(const LatticePlace& place, int headings) const {
  return {(corner_.x + place.square.x + 0.5) * side_m_,
          (corner_.y + place.square.y + 0.5) * side_m_,
          wrap_angle(2.0 * std::numbers::pi * place.heading / headings)};
}

/// Bounds of all open blocks; keeps those that may hold a candidate after what was found so far.
void GlobalSearch::sweep(const Lattice& lattice, Blocks& blocks) const {
  const BlockBounds& bounds = bounds_.front();
  std::vector<const std::uint8_t*> rows;
  std::vector<std::uint16_t> sums(static_cast<std::size_t>(bounds.blocks_x()) +
                                  BlockBounds::kSlack);
  const auto floor = [&] {
    return std::max<std::uint32_t>(
        1, static_cast<std::uint32_t>(std::ceil(config_.min_share * blocks.best)));
  };
  std::vector<LatticePlace> kept;
  for (int heading = 0; heading < lattice.headings; ++heading) {
    const std::span<const CellOffset> offsets = lattice.of(heading);
    kept.clear();
    LatticePlace likeliest;
    std::uint32_t least = floor();
    for (int y = 0; y < bounds.blocks_y(); ++y) {
      const Range& range = open_blocks_[static_cast<std::size_t>(y)];
      if (range.begin >= range.end) continue;
      bounds.row_sums(y, range.begin, range.end, offsets, rows, sums.data());
      for (int x = range.begin; x < range.end; ++x) {
        const std::uint32_t sum = sums[static_cast<std::size_t>(x)];
        const int block = y * bounds.blocks_x() + x;
        if (sum < least || open_block_[static_cast<std::size_t>(block)] == 0) continue;
        kept.push_back({heading, {x * bounds.side(), y * bounds.side()}, sum});
        if (sum > likeliest.steps) likeliest = kept.back();
      }
    }
    if (likeliest.steps > blocks.best) {
      LatticePlace found{heading, likeliest.square, 0};
      best_in_block(lattice, found, likeliest.square, bounds.levels(), blocks.best + 1);
      blocks.best = std::max(blocks.best, found.steps);
      least = floor();
    }
    for (const LatticePlace& place : kept) {
      if (place.steps >= least) blocks.places.push_back(place);
    }
  }
}

/// The best place of a block of 2^level squares, of at least `floor` steps; best.steps stays 0 when
/// there is none. Of equal ones the first by row.
void GlobalSearch::best_in_block(const Lattice& lattice, LatticePlace& best, const Cell& square,
                                 int level, std::uint32_t floor) const {
  const BlockBounds& bounds = bounds_.front();
  const std::span<const CellOffset> offsets = lattice.of(best.heading);
  if (level == 0) {
    if (!is_open(square)) return;
    const LatticePlace place{best.heading, square, bounds.at(0, square, offsets)};
    if (place.steps < floor || place.steps == 0) return;
    if (best.steps == 0 || better(place, best)) best = place;
    return;
  }
  const int half = 1 << (level - 1);
  for (const int dy : {0, half}) {
    for (const int dx : {0, half}) {
      const Cell part{square.x + dx, square.y + dy};
      if (part.x >= squares_x_ || part.y >= squares_y_) continue;
      const std::uint32_t bound = level > 1 ? bounds.at(level - 1, part, offsets) : ~0U;
      if (bound < std::max(floor, best.steps)) continue;
      best_in_block(lattice, best, part, level - 1, floor);
    }
  }
}

std::vector<GlobalSearch::LatticePlace> GlobalSearch::lattice_places(const Lattice& lattice) const {
  Blocks blocks;
  sweep(lattice, blocks);
  std::sort(blocks.places.begin(), blocks.places.end(), better);
  std::vector<LatticePlace> places;
  const auto floor = [&] {
    return std::max<std::uint32_t>(
        1, static_cast<std::uint32_t>(std::ceil(config_.min_share * blocks.best)));
  };
  const int levels = bounds_.front().levels();
  for (const LatticePlace& block : blocks.places) {
    if (block.steps < floor()) break;
    LatticePlace place{block.heading, block.square, 0};
    best_in_block(lattice, place, block.square, levels, floor());
    if (place.steps == 0) continue;
    blocks.best = std::max(blocks.best, place.steps);
    places.push_back(place);
  }
  std::sort(places.begin(), places.end(), better);
  // Of places near each other the better one.
  std::vector<LatticePlace> apart;
  const double turn = 2.0 * std::numbers::pi / lattice.headings;
  for (const LatticePlace& place : places) {
    if (place.steps < floor()) break;
    if (apart.size() >= static_cast<std::size_t>(config_.max_candidates)) break;
    const bool is_near_any =
        std::any_of(apart.begin(), apart.end(), [&](const LatticePlace& other) {
          const double distance_m = side_m_ * std::hypot(place.square.x - other.square.x,
                                                         place.square.y - other.square.y);
          return distance_m < config_.separation_m &&
                 std::abs(wrap_angle(turn * (place.heading - other.heading))) <
                     config_.separation_rad;
        });
    if (!is_near_any) apart.push_back(place);
  }
  return apart;
}

std::vector<GlobalSearch::LatticePlace> GlobalSearch::search_lattice(
    const Endpoints& endpoints) const {
  if (endpoints.size() == 0 || bounds_.empty()) return {};
  return lattice_places(make_lattice(endpoints));
}

std::vector<std::uint32_t> GlobalSearch::steps_at(const Endpoints& endpoints, int heading) const {
  const Lattice lattice = make_lattice(endpoints);
  std::vector<std::uint32_t> steps;
  for (int y = 0; y < squares_y_; ++y) {
    for (int x = 0; x < squares_x_; ++x) {
      steps.push_back(bounds_.front().at(0, {x, y}, lattice.of(heading)));
    }
  }
  return steps;
}

std::vector<PlaceCandidate> GlobalSearch::search(const Endpoints& endpoints) const {
  std::vector<PlaceCandidate> candidates;
  if (endpoints.size() == 0 || bounds_.empty()) return candidates;
  const Lattice lattice = make_lattice(endpoints);
  for (const LatticePlace& place : lattice_places(lattice)) {
    PlaceCandidate candidate{pose_of(place, lattice.headings), 0.0};
    candidate.score = settle(endpoints, candidate.map_from_robot);
    candidates.push_back(candidate);
  }
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const PlaceCandidate& a, const PlaceCandidate& b) { return a.score > b.score; });
  return candidates;
}

}  // namespace strata::localization
