// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/comparison_replay.hpp"

#include <cstddef>
#include <vector>

#include "components/maps/map_models.hpp"
#include "tools/pipeline/drive_replay.hpp"

namespace strata::pipeline {
namespace {

/// What a page takes by reference.
struct Way {
  std::vector<log::StampedPose> trajectory;
  std::vector<maps::StateRow> states;
};

/// The rows that the traces were made of (candidates.cpp), scan by scan. Times of traces are
/// seconds since the first scan; a scan of the same nanosecond is theirs.
std::vector<maps::StateRow> rows_of(const std::vector<StateTrace>& traces, const TestPart& drive) {
  std::vector<maps::StateRow> rows;
  std::vector<std::size_t> next(traces.size(), 0);
  const Stamp begin = drive.observations.front().scan.stamp;
  for (const Observation& observation : drive.observations) {
    const Stamp stamp = observation.scan.stamp;
    for (std::size_t t = 0; t < traces.size(); ++t) {
      const StateTrace& trace = traces[t];
      const auto stamp_of = [&](std::size_t i) {
        return begin + Duration::from_seconds(trace.time_s[i]);
      };
      std::size_t& at = next[t];
      while (at < trace.time_s.size() && stamp_of(at) < stamp) ++at;
      if (at == trace.time_s.size() || stamp_of(at) != stamp) continue;
      for (std::size_t c = 0; c < trace.probability.size(); ++c) {
        if (at >= trace.probability[c].size()) continue;
        rows.push_back({stamp, trace.submap, static_cast<int>(c), trace.probability[c][at]});
      }
      ++at;
    }
  }
  return rows;
}

}  // namespace

void write_comparison_replay(const Comparison& comparison, const maps::Maps& maps,
                             const TestPart& drive, const std::filesystem::path& folder) {
  DriveReplay replay{maps.filtered, drive.observations, drive.truths, {}};
  std::vector<Way> ways(comparison.models.size());
  for (std::size_t m = 0; m < ways.size(); ++m) {
    const ModelResult& model = comparison.models[m];
    if (model.runs.empty() || drive.observations.empty()) continue;
    const ModelRun& run = model.runs.front();
    // Of another drive, or scans were lost on the way.
    if (run.part != 0 || run.estimates.size() != drive.observations.size()) continue;
    for (std::size_t i = 0; i < run.estimates.size(); ++i) {
      ways[m].trajectory.push_back({drive.observations[i].scan.stamp, run.estimates[i]});
    }
    ways[m].states = rows_of(model.states, drive);
    const auto descriptor = maps::map_models().find(model.model);
    const patch::PatchMap* patches = descriptor ? maps::patches_of(*descriptor, maps) : nullptr;
    replay.tracks.push_back(
        {model.model, ways[m].trajectory, ways[m].states, {}, patches, run.shown_particles});
  }
  write_replay(folder, replay);
}

}  // namespace strata::pipeline
