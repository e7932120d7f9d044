// SPDX-License-Identifier: Apache-2.0
#include "core/registration/correlative_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/geometry/angle.hpp"

namespace strata::registration {
namespace {

/// The grid of maxima over squares twice as wide: the maximum of four shifted squares.
Grid<std::uint8_t> widened(const Grid<std::uint8_t>& grid, int half) {
  CellRect rect = grid.rect();
  rect.min.x -= half;
  rect.min.y -= half;
  Grid<std::uint8_t> result = grid.cropped(rect);
  const int width = rect.width();
  std::uint8_t* values = result.values().data();
  auto row = [&](int y) {
    return values + static_cast<std::ptrdiff_t>(y) * static_cast<std::ptrdiff_t>(width);
  };
  for (int y = 0; y < rect.height(); ++y) {
    std::uint8_t* r = row(y);
    for (int x = 0; x + half < width; ++x) r[x] = std::max(r[x], r[x + half]);
  }
  for (int y = 0; y + half < rect.height(); ++y) {
    std::uint8_t* r = row(y);
    const std::uint8_t* above = row(y + half);
    for (int x = 0; x < width; ++x) r[x] = std::max(r[x], above[x]);
  }
  return result;
}

struct Candidate {
  int turn = 0;
  int x = 0;  // offset in cells; covers [x, x + 2^level)
  int y = 0;
  int score = 0;  // sum over end points: an upper bound for what it covers, exact on level 0
};

int squared_steps(const Candidate& c) { return c.turn * c.turn + c.x * c.x + c.y * c.y; }

bool better(const Candidate& a, const Candidate& b) {
  if (a.score != b.score) return a.score > b.score;
  if (squared_steps(a) != squared_steps(b)) return squared_steps(a) < squared_steps(b);
  if (a.turn != b.turn) return a.turn < b.turn;
  if (a.x != b.x) return a.x < b.x;
  return a.y < b.y;
}

class BranchAndBound {
 public:
  BranchAndBound(const Endpoints& endpoints, const CorrelativeTables& tables, const Pose2& guess,
                 const SearchWindow& window)
      : endpoints_(endpoints), tables_(tables), guess_(guess) {
    const double resolution = tables.resolution_m();
    double farthest = resolution;
    for (std::size_t i = 0; i < endpoints.size(); ++i) {
      farthest = std::max(farthest, std::hypot(endpoints.x_m[i], endpoints.y_m[i]));
    }
    turn_step_ = resolution / farthest;
    const double reach = std::min(window.theta_rad, std::numbers::pi);
    turns_ = static_cast<int>(std::ceil(reach / turn_step_));
    reach_x_ = static_cast<int>(std::ceil(window.x_m / resolution));
    reach_y_ = static_cast<int>(std::ceil(window.y_m / resolution));
    const auto rotations = 2 * static_cast<std::size_t>(turns_) + 1;
    cells_.resize(rotations * endpoints.size());
    for (int turn = -turns_; turn <= turns_; ++turn) rotate(turn);
  }

  SearchResult run(double min_score) {
    const auto n = static_cast<double>(endpoints_.size());
    best_.score = static_cast<int>(std::ceil(min_score * 255.0 * n)) - 1;
    const int top = tables_.depth();
    std::vector<Candidate> candidates;
    const int step = 1 << top;
    for (int turn = -turns_; turn <= turns_; ++turn) {
      for (int x = -reach_x_; x <= reach_x_; x += step) {
        for (int y = -reach_y_; y <= reach_y_; y += step) {
          consider({turn, x, y, 0}, top, candidates);
        }
      }
    }
    descend(candidates, top);
    SearchResult result;
    result.found = found_;
    result.pose = guess_;
    if (!found_) return result;
    result.pose = {guess_.x + best_.x * tables_.resolution_m(),
                   guess_.y + best_.y * tables_.resolution_m(),
                   wrap_angle(guess_.theta + best_.turn * turn_step_)};
    result.score = static_cast<double>(best_.score) / (255.0 * n);
    return result;
  }

 private:
  void rotate(int turn) {
    const double theta = guess_.theta + turn * turn_step_;
    const double c = std::cos(theta);
    const double s = std::sin(theta);
    Cell* cells = cells_of(turn);
    for (std::size_t i = 0; i < endpoints_.size(); ++i) {
      cells[i] = cell_at({guess_.x + c * endpoints_.x_m[i] - s * endpoints_.y_m[i],
                          guess_.y + s * endpoints_.x_m[i] + c * endpoints_.y_m[i]},
                         tables_.resolution_m());
    }
  }
  Cell* cells_of(int turn) {
    return cells_.data() + static_cast<std::size_t>(turn + turns_) * endpoints_.size();
  }

  /// Scores the candidate and keeps it when it may still beat the best.
  void consider(Candidate candidate, int level, std::vector<Candidate>& kept) {
    const Cell* cells = cells_of(candidate.turn);
    int score = 0;
    for (std::size_t i = 0; i < endpoints_.size(); ++i) {
      score += tables_.at(level, {cells[i].x + candidate.x, cells[i].y + candidate.y});
    }
    candidate.score = score;
    if (score >= best_.score) kept.push_back(candidate);
  }

  void descend(std::vector<Candidate>& candidates, int level) {
    std::sort(candidates.begin(), candidates.end(), better);
    for (const Candidate& candidate : candidates) {
      if (candidate.score < best_.score) return;
      if (level == 0) {
        if (found_ ? better(candidate, best_) : candidate.score > best_.score) {
          best_ = candidate;
          found_ = true;
        }
        continue;
      }
      std::vector<Candidate> parts;
      const int half = 1 << (level - 1);
      for (int dx : {0, half}) {
        for (int dy : {0, half}) {
          if (candidate.x + dx > reach_x_ || candidate.y + dy > reach_y_) continue;
          consider({candidate.turn, candidate.x + dx, candidate.y + dy, 0}, level - 1, parts);
        }
      }
      descend(parts, level - 1);
    }
  }

  const Endpoints& endpoints_;
  const CorrelativeTables& tables_;
  Pose2 guess_;
  double turn_step_ = 0.0;
  int turns_ = 0;
  int reach_x_ = 0;
  int reach_y_ = 0;
  std::vector<Cell> cells_;  // end points in cells, turn by turn
  Candidate best_;
  bool found_ = false;
};

}  // namespace

CorrelativeTables::CorrelativeTables(const MatchField& field, const CorrelativeConfig& config)
    : resolution_m_(field.resolution_m()) {
  require_valid(config, "correlative_search");
  const int reach = static_cast<int>(std::ceil(2.5 * config.hit_stddev_m / resolution_m_));
  for (const SurfacePoint& point : field.points()) {
    if (!point.occupied) continue;
    const Cell cell = cell_at({point.x_m, point.y_m}, resolution_m_);
    rect_ = rect_.united(CellRect{cell, {cell.x + 1, cell.y + 1}}.inflated(reach));
  }
  Grid<std::uint8_t> finest(resolution_m_, rect_, 0);
  const double scale = -0.5 / (config.hit_stddev_m * config.hit_stddev_m);
  for (const SurfacePoint& point : field.points()) {
    if (!point.occupied) continue;
    const Cell center = cell_at({point.x_m, point.y_m}, resolution_m_);
    for (int y = center.y - reach; y <= center.y + reach; ++y) {
      for (int x = center.x - reach; x <= center.x + reach; ++x) {
        const Eigen::Vector2d at = cell_center({x, y}, resolution_m_);
        const double dx = at.x() - point.x_m;
        const double dy = at.y() - point.y_m;
        const auto value =
            static_cast<std::uint8_t>(std::lround(255.0 * std::exp(scale * (dx * dx + dy * dy))));
        std::uint8_t& cell = finest.at({x, y});
        cell = std::max(cell, value);
      }
    }
  }
  levels_.push_back(std::move(finest));
  for (int level = 1; level <= config.depth; ++level) {
    levels_.push_back(widened(levels_.back(), 1 << (level - 1)));
  }
}

SearchResult search(const Endpoints& endpoints, const CorrelativeTables& tables, const Pose2& guess,
                    const SearchWindow& window, double min_score) {
  if (endpoints.size() == 0 || tables.rect().empty()) return {false, guess, 0.0};
  return BranchAndBound(endpoints, tables, guess, window).run(min_score);
}

}  // namespace strata::registration
