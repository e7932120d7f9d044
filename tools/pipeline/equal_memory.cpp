// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/equal_memory.hpp"

#include <algorithm>
#include <cstdio>
#include <span>
#include <utility>

namespace strata::pipeline {
namespace {

/// Adds a part's runs to a point of a curve.
void add_runs(std::span<const ModelRun> runs, std::size_t part, std::size_t seeds,
              MemoryPoint& point) {
  std::size_t taken = 0;
  for (const ModelRun& run : runs) {
    if (run.part != part || taken == seeds) continue;
    ++taken;
    point.run_means_m.push_back(run.metrics.error_m.mean);
    point.lost_runs += run.metrics.lost ? 1 : 0;
  }
}

Learned learn_again(const Runs& runs, const FullMemory& full, const CompareConfig& config,
                    const CompareJob& job) {
  Learned learned;
  const std::vector<Observation> train = learning_part(runs, full.split);
  learned.result = learn(train, poses_of(full.learned.result.slam, train), config.learn, {},
                         job.seeds.front(), job.threads, job.progress);
  learned.result.places = full.learned.result.places;
  add_place_patches(config, job, learned.result);
  learned.maps = maps_of(learned.result, config.decoding, config.timescale_use);
  return learned;
}

/// One a step after the first, side by side.
std::vector<Learned> learn_steps(const Runs& runs, const FullMemory& full,
                                 const CompareConfig& config, const CompareConfig& less,
                                 const CompareJob& job, WorkerPool& pool) {
  std::vector<Learned> learned(static_cast<std::size_t>(config.protocol.memory_steps));
  pool.for_chunks(learned.size(), 1, [&](std::size_t i, std::size_t /*end*/, std::size_t /*c*/) {
    CompareConfig own = less;
    own.learn = with_less_memory(config.learn, static_cast<int>(i) + 1);
    learned[i] = learn_again(runs, full, own, job);
  });
  return learned;
}

/// Of each drive, so that all drives together have as many runs as the configuration says.
std::size_t memory_seeds(const Runs& runs, const CompareConfig& config, const CompareJob& job) {
  const std::size_t drives = std::max<std::size_t>(1, count_drives(runs, job.splits));
  const auto wanted = static_cast<std::size_t>(config.protocol.memory_seeds);
  return std::min(job.seeds.size(), (wanted + drives - 1) / drives);
}

/// The model's point at a step; made when it is not there yet.
MemoryPoint& point_of(ModelResult& result, std::size_t step) {
  if (result.memory.size() <= step) result.memory.resize(step + 1);
  return result.memory[step];
}

}  // namespace

maps::LearnConfig with_less_memory(const maps::LearnConfig& config, int step) {
  maps::LearnConfig less = config;
  const int factor = 1 << step;
  less.slam.given_poses.refine = false;
  less.slam.beam_filter.resolution_m *= factor;
  less.timescale.angle_bins = std::max(3, less.timescale.angle_bins / factor);
  less.timescale.node_spacing_m *= factor;
  less.timescale.update_radius_m *= factor;
  for (memory::LevelConfig& level : less.timescale.levels) {
    level.samples = std::max(1, level.samples / factor);
  }
  return less;
}

std::string memory_setting(const maps::MapModelDescriptor& model, const maps::LearnConfig& config) {
  if (!model.needs_part(maps::MapPart::kTimescale)) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f m cells", config.slam.beam_filter.resolution_m);
    return text;
  }
  std::string text = std::to_string(config.timescale.angle_bins) + " bins, ";
  for (std::size_t l = 0; l < config.timescale.levels.size(); ++l) {
    text += (l > 0 ? "/" : "") + std::to_string(config.timescale.levels[l].samples);
  }
  char spacing[40];
  std::snprintf(spacing, sizeof spacing, " samples, nodes %g m apart",
                config.timescale.node_spacing_m);
  return text + spacing;
}

std::size_t count_memory_runs(const Runs& runs, const CompareConfig& config,
                              const CompareJob& job) {
  const std::vector<std::string>& models = config.protocol.models;
  const auto learned = std::count_if(models.begin(), models.end(), [&](const std::string& model) {
    return job.map_models->at(model)->is_learned();
  });
  return static_cast<std::size_t>(config.protocol.memory_steps) * count_drives(runs, job.splits) *
         static_cast<std::size_t>(learned) * memory_seeds(runs, config, job);
}

void add_memory_curves(const Runs& runs, const FullMemory& full, const CompareConfig& config,
                       const CompareJob& job, WorkerPool& pool, SharedProgress& progress,
                       std::vector<ModelResult>& results) {
  const int steps = config.protocol.memory_steps;
  if (steps == 0) return;
  const std::size_t count = memory_seeds(runs, config, job);
  const std::span<const std::uint64_t> seeds = std::span(job.seeds).first(count);
  CompareConfig less = config;
  std::erase_if(less.protocol.models,
                [&](const auto& model) { return !job.map_models->at(model)->is_learned(); });
  const std::vector<Learned> learned = learn_steps(runs, full, config, less, job, pool);
  for (int step = 0; step <= steps; ++step) {
    less.learn = with_less_memory(config.learn, step);
    const Learned* own = step > 0 ? &learned[static_cast<std::size_t>(step - 1)] : nullptr;
    std::vector<maps::MapModel> models;
    if (own != nullptr) models = make_models(own->maps, less, job);
    for (std::size_t p = 0; p < full.parts.size(); ++p) {
      std::vector<ModelResult> fresh(models.size());
      if (own != nullptr) {
        run_candidates(make_candidates(models, localize_here, {}, *own, less, full.parts[p]),
                       full.parts[p], 0, seeds, pool, progress, fresh);
      }
      std::size_t next = 0;
      for (std::size_t m = 0; m < config.protocol.models.size(); ++m) {
        const auto model = job.map_models->at(config.protocol.models[m]);
        if (!model->is_learned()) continue;
        MemoryPoint& point = point_of(results[m], static_cast<std::size_t>(step));
        point.setting = memory_setting(*model, less.learn);
        if (step == 0) {
          point.bytes = results[m].map_bytes;
          add_runs(results[m].runs, p, count, point);
        } else {
          if (point.bytes == 0) point.bytes = models[next].bytes;
          add_runs(fresh[next].runs, 0, count, point);
        }
        ++next;
      }
    }
  }
}

std::vector<MemoryBudget> equal_memory(const Comparison& comparison) {
  std::vector<std::size_t> sizes;
  for (const ModelResult& model : comparison.models) {
    if (!model.memory.empty()) sizes.push_back(model.memory.front().bytes);
  }
  std::sort(sizes.begin(), sizes.end());
  std::vector<MemoryBudget> budgets;
  for (const std::size_t bytes : sizes) {
    const bool is_alike = !budgets.empty() && 10 * bytes <= 11 * budgets.back().bytes;
    if (!is_alike) budgets.emplace_back();
    budgets.back().bytes = bytes;
  }
  for (MemoryBudget& budget : budgets) {
    for (const ModelResult& model : comparison.models) {
      const MemoryPoint* best = nullptr;
      for (const MemoryPoint& point : model.memory) {
        if (point.bytes > budget.bytes) continue;
        if (best == nullptr || point.bytes > best->bytes) best = &point;
      }
      budget.points.push_back(best);
    }
  }
  return budgets;
}

}  // namespace strata::pipeline
