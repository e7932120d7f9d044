// SPDX-License-Identifier: Apache-2.0
#include "core/patch/sequences.hpp"

#include <algorithm>
#include <cmath>

#include "core/grid/ray_traversal.hpp"

namespace strata::patch {
namespace {

constexpr std::size_t kProgressStride = 256;

/// Longer than so many periods of its scans a sequence is not without one that follows ...
constexpr double kHolePeriods = 3.0;
/// ... nor longer than this: thinned logs have a scan each 10 s of a robot that stands.
constexpr double kMaxHole_s = 10.5;

int touching_beams(const std::vector<Ray>& rays, const CellRect& rect, double resolution_m,
                   int enough) {
  int count = 0;
  double enter = 0.0;
  double leave = 0.0;
  for (const Ray& ray : rays) {
    if (clip_to_rect(ray.from_m, ray.to_m, rect, resolution_m, enter, leave)) ++count;
    if (count >= enough) break;
  }
  return count;
}

}  // namespace

double distance_m(const Eigen::Vector2d& point_m, const CellRect& rect, double resolution_m) {
  const double dx = std::max(
      {0.0, rect.min.x * resolution_m - point_m.x(), point_m.x() - rect.max.x * resolution_m});
  const double dy = std::max(
      {0.0, rect.min.y * resolution_m - point_m.y(), point_m.y() - rect.max.y * resolution_m});
  return std::hypot(dx, dy);
}

double SequenceBuilder::longest_pause_s(bool is_next) const {
  if (!is_next) return config_->hysteresis_s;
  const auto steps = static_cast<double>(open_.scans.size()) - 1.0;
  const double hole_s =
      steps > 0.0 ? std::min(kMaxHole_s, kHolePeriods * (last_ - first_).seconds() / steps)
                  : kMaxHole_s;
  return std::max(config_->hysteresis_s, hole_s);
}

bool SequenceBuilder::must_close(int run, Stamp stamp, bool is_next) const {
  return run != run_ || (stamp - last_).seconds() > longest_pause_s(is_next) ||
         (stamp - first_).seconds() > config_->max_duration_s;
}

std::optional<Sequence> SequenceBuilder::finish() {
  std::optional<Sequence> ended;
  if (open_.scans.size() >= static_cast<std::size_t>(config_->min_scans)) {
    ended = std::move(open_);
  }
  open_ = {};
  return ended;
}

std::optional<Sequence> SequenceBuilder::pass(int run, Stamp stamp) {
  if (open_.scans.empty() || !must_close(run, stamp, false)) return std::nullopt;
  return finish();
}

std::optional<Sequence> SequenceBuilder::take(std::uint32_t scan, int run, Stamp stamp) {
  std::optional<Sequence> ended;
  if (!open_.scans.empty() && must_close(run, stamp, scan == open_.scans.back() + 1)) {
    ended = finish();
  }
  if (open_.scans.empty()) first_ = stamp;
  open_.scans.push_back(scan);
  run_ = run;
  last_ = stamp;
  return ended;
}

void SequenceMembership::set_scan(const PosedScan& scan) {
  robot_m_ = scan.map_from_robot.translation();
  laser_m_ = scan.map_from_laser().translation();
  rays_.clear();
  reach_m_ = 0.0;
  if (config_->mode != SequenceMode::kVisibility) return;
  for_each_ray(scan.scan, scan.map_from_laser(), *counting_, [&](std::size_t, const Ray& ray) {
    rays_.push_back(ray);
    reach_m_ = std::max(reach_m_, (ray.to_m - ray.from_m).norm());
  });
}

bool SequenceMembership::belongs_to(const CellRect& rect) const {
  if (config_->mode == SequenceMode::kEntered) {
    return distance_m(robot_m_, rect, resolution_m_) <= config_->entry_margin_m;
  }
  return distance_m(laser_m_, rect, resolution_m_) <= reach_m_ &&
         touching_beams(rays_, rect, resolution_m_, config_->min_beams_per_scan) >=
             config_->min_beams_per_scan;
}

bool clip_to_rect(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m, const CellRect& rect,
                  double resolution_m, double& t_enter, double& t_leave) {
  t_enter = 0.0;
  t_leave = 1.0;
  const double low[2] = {rect.min.x * resolution_m, rect.min.y * resolution_m};
  const double high[2] = {rect.max.x * resolution_m, rect.max.y * resolution_m};
  for (int axis = 0; axis < 2; ++axis) {
    const double start = from_m[axis];
    const double step = to_m[axis] - start;
    if (step == 0.0) {
      if (start < low[axis] || start >= high[axis]) return false;
      continue;
    }
    const double a = (low[axis] - start) / step;
    const double b = (high[axis] - start) / step;
    t_enter = std::max(t_enter, std::min(a, b));
    t_leave = std::min(t_leave, std::max(a, b));
    if (t_enter > t_leave) return false;
  }
  return true;
}

std::vector<std::vector<Sequence>> find_sequences(std::span<const PosedScan> scans,
                                                  std::span<const CellRect> rects,
                                                  double resolution_m, const SequenceConfig& config,
                                                  const CountingOptions& counting,
                                                  Progress* progress) {
  std::vector<SequenceBuilder> builders(rects.size(), SequenceBuilder(config));
  std::vector<std::vector<Sequence>> result(rects.size());
  const auto keep = [&](std::size_t s, std::optional<Sequence> ended) {
    if (ended) result[s].push_back(std::move(*ended));
  };
  SequenceMembership membership(config, counting, resolution_m);
  for (std::size_t t = 0; t < scans.size() && !rects.empty(); ++t) {
    if (t % kProgressStride == 0) report_progress(progress, "find sequences", t, scans.size());
    const PosedScan& scan = scans[t];
    membership.set_scan(scan);
    for (std::size_t s = 0; s < rects.size(); ++s) {
      if (!membership.belongs_to(rects[s])) continue;
      keep(s, builders[s].take(static_cast<std::uint32_t>(t), scan.run, scan.scan.stamp));
    }
  }
  for (std::size_t s = 0; s < rects.size(); ++s) keep(s, builders[s].finish());
  return result;
}

Grid<CellCounts> count_sequence(std::span<const PosedScan> scans, const Sequence& sequence,
                                const CellRect& rect, double resolution_m,
                                const CountingOptions& counting) {
  Grid<CellCounts> counts(resolution_m, rect);
  for (const std::uint32_t index : sequence.scans) {
    const PosedScan& scan = scans[index];
    for_each_ray(scan.scan, scan.map_from_laser(), counting, [&](std::size_t, const Ray& ray) {
      double enter = 0.0;
      double leave = 0.0;
      if (!clip_to_rect(ray.from_m, ray.to_m, rect, resolution_m, enter, leave)) return;
      const Eigen::Vector2d along = ray.to_m - ray.from_m;
      const Cell end = cell_at(ray.to_m, resolution_m);
      const Eigen::Vector2d from = ray.from_m + enter * along;
      const Eigen::Vector2d to =
          leave < 1.0 ? Eigen::Vector2d(ray.from_m + leave * along) : ray.to_m;
      traverse_ray(from, to, resolution_m, [&](const Cell& cell, double length_m) {
        // Rounding may put the ends of the clipped part a hair outside.
        if (!rect.contains(cell) || (ray.is_hit && cell == end)) return;
        counts.at(cell).misses += length_m / resolution_m;
      });
      if (ray.is_hit && rect.contains(end)) counts.at(end).hits += 1.0;
    });
  }
  return counts;
}

}  // namespace strata::patch
