// SPDX-License-Identifier: Apache-2.0
#include "core/beam_filter/beam_filter.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "core/grid/count_scans.hpp"

namespace strata::beam_filter {
namespace {

double clamp_for_log(double m) { return std::clamp(m, kLogMargin, 1.0 - kLogMargin); }

/// ln P(end | m) with c summed out.
double log_end(double m, double prior) {
  return std::log((1.0 - prior) + (2.0 * prior - 1.0) * clamp_for_log(m));
}

double log_pass(double m) { return std::log(1.0 - clamp_for_log(m)); }

struct Likelihoods {
  double incomplete = 0.0;
  double expected = 0.0;
};

/// EM over one set of counts. Only cells with hits move: the others are 0 or unknown for good.
class CountsFilter {
 public:
  CountsFilter(const TiledGrid<CellCounts>& counts, const BeamFilterConfig& config)
      : config_(config),
        hit_index_(counts.resolution_m(), counts.rect(), -1),
        map_(make_reflection_grid(counts.resolution_m(), counts.rect())) {
    counts.visit_rows([&](const Cell& first, std::span<const CellCounts> row) {
      float* known = &map_.at(first);
      for (std::size_t i = 0; i < row.size(); ++i) {
        if (!(row[i].total() >= config.min_evidence)) continue;
        known[i] = 0.0F;
        if (row[i].hits > 0.0) {
          hit_cells_.push_back({{first.x + static_cast<int>(i), first.y}, row[i], 0.0});
        } else {
          passed_ += row[i].misses;
        }
      }
    });
    judged_.resize(hit_cells_.size());
    if (!config.endpoint_tolerance) return;
    for (std::size_t k = 0; k < hit_cells_.size(); ++k) {
      hit_index_.at(hit_cells_[k].cell) = static_cast<std::int32_t>(k);
    }
  }

  /// Round 0: e is the prior for every beam.
  void start() {
    for (HitCell& hit : hit_cells_) {
      hit.reflection = config_.prior * (hit.counts.hits / hit.counts.total());
    }
  }

  /// E-step and M-step.
  void step() {
    judge();
    for (std::size_t k = 0; k < hit_cells_.size(); ++k) {
      hit_cells_[k].reflection = em_step(judged_[k], hit_cells_[k].counts, config_.prior);
    }
  }

  void jump_to_limit() {
    for (HitCell& hit : hit_cells_) {
      hit.reflection = closed_form(hit.counts, config_.prior, config_.min_evidence);
    }
  }

  [[nodiscard]] Likelihoods likelihoods() {
    judge();
    // Cells that beams only passed have m = 0.
    const double free = passed_ * log_pass(0.0);
    Likelihoods sum{free, free};
    for (std::size_t k = 0; k < hit_cells_.size(); ++k) {
      const CellCounts& counts = hit_cells_[k].counts;
      const double m = clamp_for_log(judged_[k]);
      const double passing = counts.misses * log_pass(hit_cells_[k].reflection);
      const double e = expectation(judged_[k], config_.prior);
      sum.incomplete += passing + counts.hits * log_end(m, config_.prior);
      sum.expected +=
          passing + counts.hits * (e * std::log(config_.prior * m) +
                                   (1.0 - e) * std::log((1.0 - config_.prior) * (1.0 - m)));
    }
    return sum;
  }

  /// Gives the map away.
  [[nodiscard]] ReflectionGrid take_map() {
    for (const HitCell& hit : hit_cells_) map_.at(hit.cell) = static_cast<float>(hit.reflection);
    return std::move(map_);
  }

 private:
  struct HitCell {
    Cell cell;
    CellCounts counts;
    double reflection = 0.0;
  };
  [[nodiscard]] double reflection(const Cell& cell) const {
    const std::int32_t index = hit_index_.get(cell);
    if (index >= 0) return hit_cells_[static_cast<std::size_t>(index)].reflection;
    return static_cast<double>(map_.get(cell));
  }
  void judge() {
    for (std::size_t k = 0; k < hit_cells_.size(); ++k) {
      judged_[k] = config_.endpoint_tolerance
                       ? judging_reflection(hit_cells_[k].cell, true,
                                            [&](const Cell& cell) { return reflection(cell); })
                       : hit_cells_[k].reflection;
    }
  }

  const BeamFilterConfig& config_;
  std::vector<HitCell> hit_cells_;     ///< known cells with hits, row by row
  TiledGrid<std::int32_t> hit_index_;  ///< which of those a cell is, for its neighbours; -1: none
  std::vector<double> judged_;         ///< per hit cell, what judges a beam that ends there
  double passed_ = 0.0;                ///< misses of known cells without hits
  ReflectionGrid map_;                 ///< 0 where known; what hit cells reflect comes at the end
};

/// Hits, and those judged dynamic.
struct LabelCounts {
  std::size_t hits = 0;
  std::size_t dynamic = 0;
};

LabelCounts label_into(const Scan& scan, const Pose2& map_from_laser, const ReflectionGrid& map,
                       const BeamFilterConfig& config, std::vector<float>& labels) {
  LabelCounts counts;
  labels.assign(scan.size(), static_cast<float>(config.prior));
  for_each_ray(scan, map_from_laser, config.counting, [&](std::size_t beam, const Ray& ray) {
    if (!ray.is_hit) return;
    ++counts.hits;
    const float m = judging_reflection(map.cell_at(ray.to_m), config.endpoint_tolerance,
                                       [&](const Cell& cell) { return map.get(cell); });
    if (!is_known(m)) return;
    labels[beam] = static_cast<float>(expectation(static_cast<double>(m), config.prior));
    if (is_dynamic(labels[beam])) ++counts.dynamic;
  });
  return counts;
}

}  // namespace

std::vector<float> label(const Scan& scan, const Pose2& map_from_laser, const ReflectionGrid& map,
                         const BeamFilterConfig& config) {
  std::vector<float> labels;
  label_into(scan, map_from_laser, map, config, labels);
  return labels;
}

double label_all(std::span<PosedScan> scans, const ReflectionGrid& map,
                 const BeamFilterConfig& config, WorkerPool& pool, Progress* progress) {
  constexpr std::size_t kChunk = 64;
  constexpr std::size_t kRound = 2048;
  LabelCounts sum;
  for (std::size_t begin = 0; begin < scans.size(); begin += kRound) {
    report_progress(progress, "label beams", begin, scans.size());
    const std::size_t count = std::min(kRound, scans.size() - begin);
    std::vector<LabelCounts> partial((count + kChunk - 1) / kChunk);
    pool.for_chunks(count, kChunk, [&](std::size_t first, std::size_t last, std::size_t chunk) {
      for (std::size_t i = begin + first; i < begin + last; ++i) {
        PosedScan& scan = scans[i];
        const LabelCounts counts =
            label_into(scan.scan, scan.map_from_laser(), map, config, scan.static_probability);
        partial[chunk].hits += counts.hits;
        partial[chunk].dynamic += counts.dynamic;
      }
    });
    for (const LabelCounts& counts : partial) {
      sum.hits += counts.hits;
      sum.dynamic += counts.dynamic;
    }
  }
  report_progress(progress, "label beams", scans.size(), scans.size());
  if (sum.hits == 0) return 0.0;
  return static_cast<double>(sum.dynamic) / static_cast<double>(sum.hits);
}

CountsResult filter_counts(const CountingMap& raw, const BeamFilterConfig& config) {
  require_valid(config, "beam_filter");
  CountsFilter filter(raw.cells(), config);
  CountsResult result;
  auto record = [&] {
    const Likelihoods now = filter.likelihoods();
    result.log_likelihood.push_back(now.incomplete);
    result.expected_log_likelihood.push_back(now.expected);
  };
  filter.start();
  record();
  if (config.mode == Mode::kClosedForm) {
    filter.jump_to_limit();
    // One more round in which neighbours judge: cells before a wall keep what its beams left there.
    if (config.endpoint_tolerance) filter.step();
    record();
  } else {
    int small_gains = 0;
    while (result.iterations < config.max_iterations && small_gains < 2) {
      const double before = result.log_likelihood.back();
      filter.step();
      ++result.iterations;
      record();
      const double gain = result.log_likelihood.back() - before;
      small_gains = gain < config.min_gain * std::abs(before) ? small_gains + 1 : 0;
    }
    result.converged = small_gains >= 2;
  }
  result.filtered = filter.take_map();
  return result;
}

FixedPoseResult filter_at_fixed_poses(std::span<PosedScan> scans, const BeamFilterConfig& config,
                                      WorkerPool& pool, Progress* progress) {
  require_valid(config, "beam_filter");
  FixedPoseResult result;
  result.raw = count_scans(scans, config.resolution_m, config.counting, BeamWeights::kAllStatic,
                           pool, progress);
  CountsResult counts = filter_counts(result.raw, config);
  result.filtered = std::move(counts.filtered);
  result.log_likelihood = std::move(counts.log_likelihood);
  result.expected_log_likelihood = std::move(counts.expected_log_likelihood);
  result.iterations = counts.iterations;
  result.converged = counts.converged;
  result.dynamic_fraction = label_all(scans, result.filtered, config, pool, progress);
  return result;
}

}  // namespace strata::beam_filter
