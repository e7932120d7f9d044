// SPDX-License-Identifier: Apache-2.0
#include "tests/across/lifelong/map_quality.hpp"

#include <cmath>

#include "components/maps/map_model.hpp"
#include "core/localization/localizer_config.hpp"
#include "tools/pipeline/localize.hpp"

namespace strata::test {
namespace {

constexpr double kLostM = 0.5;

}  // namespace

MapQuality judge(const maps::Maps& maps, std::span<const PosedScan> mapped, const Truth& truth,
                 const simulate::SimulatedDay& new_day, std::span<const std::uint64_t> seeds) {
  MapQuality quality;
  quality.scans = mapped.size();
  quality.submaps = maps.patches ? maps.patches->submaps.size() : 0;
  std::vector<Pose2> learned;
  std::vector<Pose2> right;
  for (const PosedScan& scan : mapped) {
    const auto found = truth.find(scan.scan.stamp.ns);
    if (found == truth.end()) continue;
    learned.push_back(scan.map_from_robot);
    right.push_back(found->second);
  }
  const Pose2 map_from_truth = align(right, learned);
  double squared = 0.0;
  for (std::size_t i = 0; i < learned.size(); ++i) {
    squared += std::pow(translation_distance(map_from_truth * right[i], learned[i]), 2);
  }
  quality.trajectory_m = std::sqrt(squared / static_cast<double>(learned.size()));

  std::vector<Observation> observations;
  std::vector<std::optional<Pose2>> truths;
  for (const simulate::SimulatedScan& scan : new_day.scans) {
    observations.push_back(scan.observation);
    truths.emplace_back(map_from_truth * scan.map_from_robot);
  }
  const maps::MapModel model = maps::make_map_model(maps, "patch", {});
  const Pose2Gaussian start{*truths.front(), Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal()};
  std::size_t count = 0;
  for (const std::uint64_t seed : seeds) {
    const pipeline::LocalizationRun run = pipeline::localize(
        observations, truths, model, maps.filtered, {}, {start}, seed, 1, nullptr);
    for (const pipeline::ScanError& error : run.errors) {
      quality.localization_m += error.error_m;
      quality.lost += error.error_m > kLostM ? 1.0 : 0.0;
      ++count;
    }
  }
  quality.localization_m /= static_cast<double>(count);
  quality.lost /= static_cast<double>(count);
  return quality;
}

}  // namespace strata::test
