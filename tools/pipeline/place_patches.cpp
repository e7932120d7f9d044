// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/place_patches.hpp"

#include <utility>

#include "core/patch/patch_learner.hpp"
#include "core/topology/partition.hpp"
#include "core/topology/topology_mapper.hpp"

namespace strata::pipeline {
namespace {

/// Between two runs, on the clock that joins them.
constexpr double kPauseS = 1.0;

}  // namespace

std::vector<double> topology_places(std::span<const PosedScan> scans,
                                    const topology::TopologyMapperConfig& config,
                                    std::uint64_t seed, int threads, Progress* progress) {
  topology::TopologyMapper mapper(config, seed, threads);
  const auto take = [&](std::vector<topology::MadeVisit> visits) {
    for (topology::MadeVisit& visit : visits) (void)mapper.update(std::move(visit));
  };
  // The mapper follows one drive. At known poses several are one that jumps between them.
  Stamp last;
  Duration shift;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    Observation observation;
    observation.scan = scans[i].scan;
    if (i > 0 && scans[i].run != scans[i - 1].run) {
      shift = last + Duration::from_seconds(kPauseS) - scans[i].scan.stamp;
    }
    observation.scan.stamp = observation.scan.stamp + shift;
    last = observation.scan.stamp;
    take(mapper.add(observation, &scans[i].map_from_robot));
    report_progress(progress, "find places", i + 1, scans.size());
  }
  take(mapper.finish());
  std::vector<double> places;
  if (mapper.posterior().empty()) return places;
  const topology::Hypothesis& likeliest = mapper.posterior().front();
  for (const std::size_t first : topology::first_visits(likeliest.labels)) {
    places.push_back(likeliest.poses[first].x);
    places.push_back(likeliest.poses[first].y);
  }
  return places;
}

patch::PatchMap learn_place_patches(const slam::SlamResult& result,
                                    const std::vector<double>& places,
                                    const patch::PatchLearnerConfig& config, int threads,
                                    Progress* progress) {
  patch::PatchLearnerConfig by_places = config;
  by_places.regions.places = places;
  patch::PatchLearner learner(by_places, threads);
  for (const PosedScan& scan : result.scans) learner.add(scan);
  return learner.finish(result.filtered, progress);
}

}  // namespace strata::pipeline
