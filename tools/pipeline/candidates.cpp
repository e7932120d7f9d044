// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/candidates.hpp"

#include <iterator>
#include <map>
#include <utility>

namespace strata::pipeline {
namespace {

/// Traces of the first seed's states, by sub-map.
std::vector<StateTrace> traces_of(const std::vector<maps::StateRow>& rows, Stamp begin) {
  std::map<int, StateTrace> traces;
  for (const maps::StateRow& row : rows) {
    StateTrace& trace = traces[row.submap];
    trace.submap = row.submap;
    const auto configuration = static_cast<std::size_t>(row.configuration);
    if (trace.probability.size() <= configuration) trace.probability.resize(configuration + 1);
    if (configuration == 0) trace.time_s.push_back((row.stamp - begin).seconds());
    trace.probability[configuration].push_back(row.probability);
  }
  std::vector<StateTrace> result;
  for (auto& [submap, trace] : traces) result.push_back(std::move(trace));
  return result;
}

}  // namespace

std::vector<maps::MapModel> make_models(const maps::Maps& maps, const CompareConfig& config,
                                        const CompareJob& job) {
  std::vector<maps::MapModel> models;
  for (const std::string& name : config.protocol.models) {
    models.push_back(maps::make_map_model(maps, name, config.sensor, *job.map_models));
  }
  return models;
}

LocalizationRun localize_here(const LocalizeJob& job) {
  return localize(job.observations, job.truths, job.model, job.free_space, job.config, {job.start},
                  job.seed, 1, nullptr);
}

std::vector<Candidate> make_candidates(const std::vector<maps::MapModel>& models,
                                       const LocalizeFunction& localize_one,
                                       const std::vector<Peer>& peers, const Learned& learned,
                                       const CompareConfig& config, const TestPart& part) {
  std::vector<Candidate> candidates;
  for (const maps::MapModel& model : models) {
    candidates.push_back({model.bytes, model.resident_bytes, [&](std::uint64_t seed) {
                            return localize_one({part.observations, part.truths, model,
                                                 learned.maps.filtered, config.localizer,
                                                 part.start, seed});
                          }});
  }
  for (const Peer& peer : peers) {
    const ReflectionGrid& map = learned.maps.occupancy;
    candidates.push_back({map.size(), map.size() * sizeof(float), [&](std::uint64_t seed) {
                            return peer.localize(
                                {part.observations, part.truths, models.front(),
                                 learned.maps.filtered, config.localizer, part.start, seed},
                                map);
                          }});
  }
  return candidates;
}

void run_candidates(const std::vector<Candidate>& candidates, const TestPart& part,
                    std::size_t part_index, std::span<const std::uint64_t> seeds, WorkerPool& pool,
                    SharedProgress& progress, std::vector<ModelResult>& results) {
  std::vector<ModelRun> runs(candidates.size() * seeds.size());
  std::vector<std::vector<maps::StateRow>> states(candidates.size());
  pool.for_chunks(runs.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    const std::size_t c = i / seeds.size();
    LocalizationRun run = candidates[c].localize(seeds[i % seeds.size()]);
    ModelRun& kept = runs[i];
    kept.part = part_index;
    kept.seed = seeds[i % seeds.size()];
    kept.metrics = evaluate_run(run.errors);
    kept.errors = std::move(run.errors);
    kept.update_ms = std::move(run.update_ms);
    for (const log::StampedPose& pose : run.trajectory) {
      kept.estimates.push_back(pose.pose);
    }
    judge_changed_places(part, kept);
    if (i % seeds.size() == 0) {
      states[c] = std::move(run.states);
      kept.shown_particles = std::move(run.shown_particles);
    }
    progress.one_done();
  });
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    ModelResult& result = results[c];
    if (part_index == 0) {
      result.map_bytes = candidates[c].map_bytes;
      result.resident_bytes = candidates[c].resident_bytes;
      result.states = traces_of(states[c], part.observations.front().scan.stamp);
    }
    const auto first = runs.begin() + static_cast<std::ptrdiff_t>(c * seeds.size());
    std::move(first, first + static_cast<std::ptrdiff_t>(seeds.size()),
              std::back_inserter(result.runs));
  }
}

}  // namespace strata::pipeline
