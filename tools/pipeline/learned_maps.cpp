// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/learned_maps.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "core/base/error.hpp"
#include "core/rays/ray_caster.hpp"
#include "tools/pipeline/place_patches.hpp"

namespace strata::pipeline {
namespace {

/// map_from_truth, from the learning part; one entry a learned observation.
Pose2 align_truth(const Poses& truths, const Poses& learned) {
  std::vector<Pose2> source;
  std::vector<Pose2> target;
  for (std::size_t i = 0; i < learned.size(); ++i) {
    if (!truths[i] || !learned[i]) continue;
    source.push_back(*truths[i]);
    target.push_back(*learned[i]);
  }
  if (source.empty()) {
    throw InputError("--truth", "has no pose in the learning part",
                     "check that it belongs to this log");
  }
  return align(source, target);
}

}  // namespace

bool any_known(const Poses& poses) {
  return std::any_of(poses.begin(), poses.end(), [](const auto& pose) { return pose.has_value(); });
}

Poses poses_of(const slam::SlamResult& result, std::span<const Observation> observations) {
  std::map<std::pair<int, std::int64_t>, Pose2> by_scan;
  for (const PosedScan& scan : result.scans) {
    by_scan[{scan.run, scan.scan.stamp.ns}] = scan.map_from_robot;
  }
  Poses poses;
  for (const Observation& observation : observations) {
    const auto found = by_scan.find({observation.run, observation.scan.stamp.ns});
    poses.push_back(found == by_scan.end() ? std::nullopt : std::optional(found->second));
  }
  return poses;
}

Poses joint_trajectory(const Runs& runs, const CompareConfig& config, int threads,
                       Progress* progress) {
  LearnParts nothing_else{.patch = false, .timescale = false};
  const LearnResult all =
      learn(runs.observations, {}, config.learn, nothing_else, 1, threads, progress);
  return poses_of(all.slam, runs.observations);
}

maps::Maps maps_of(const LearnResult& result, const memory::DecodingConfig& decoding,
                   const maps::TimescaleUseConfig& use) {
  maps::Maps maps;
  maps.occupancy = result.slam.occupancy;
  maps.filtered = result.slam.filtered;
  maps.patches = result.patches;
  maps.place_patches = result.place_patches;
  maps.timescale = result.timescale;
  maps.visit_scans = [scans = std::span<const PosedScan>(result.slam.scans)](const auto& visit) {
    for (const PosedScan& scan : scans) visit(scan);
  };
  maps.decoding = decoding;
  maps.timescale_use = use;
  if (maps.timescale) maps.nodes = maps.timescale->decode(decoding);
  if (maps.timescale && use.base_map) {
    maps.filtered_caster = std::make_shared<const rays::RayCaster>(maps.filtered);
  }
  return maps;
}

void add_place_patches(const CompareConfig& config, const CompareJob& job, LearnResult& result) {
  const std::vector<std::string>& models = config.protocol.models;
  const bool is_needed = std::any_of(models.begin(), models.end(), [&](const std::string& model) {
    return job.map_models->at(model)->needs_part(maps::MapPart::kPlacePatches);
  });
  if (!is_needed) return;
  if (result.places.empty()) {
    result.places = topology_places(result.slam.scans, config.topology, job.seeds.front(),
                                    job.threads, job.progress);
  }
  result.place_patches = learn_place_patches(result.slam, result.places, config.learn.patch,
                                             job.threads, job.progress);
}

Learned learn_split(const Runs& runs, const Split& split, const Poses& poses,
                    const CompareConfig& config, const CompareJob& job) {
  Learned learned;
  const std::vector<Observation> train = learning_part(runs, split);
  learned.result = learn(train, pick(poses, split.train), config.learn, {}, job.seeds.front(),
                         job.threads, job.progress);
  add_place_patches(config, job, learned.result);
  learned.truths = poses;
  learned.maps = maps_of(learned.result, config.decoding, config.timescale_use);
  maps::Maps& maps = learned.maps;
  maps.given = job.given_map;
  if (any_known(runs.truths)) {
    const Pose2 map_from_truth =
        align_truth(pick(runs.truths, split.train), poses_of(learned.result.slam, train));
    learned.truths = runs.truths;
    for (auto& truth : learned.truths) {
      if (truth) truth = map_from_truth * *truth;
    }
    maps.map_from_truth = map_from_truth;
    maps.given_from_map = inverse(map_from_truth);
  }
  return learned;
}

}  // namespace strata::pipeline
