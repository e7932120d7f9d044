// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/box_way.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/localization/localizer.hpp"
#include "core/patch/sequences.hpp"
#include "tools/laboratory/experiments/patch_models.hpp"

namespace strata::experiments {
namespace {

constexpr double kAroundWay_s = 3.0;

/// The part of the day about the first stay near the sub-map.
std::optional<WayThrough> cut(WayThrough way) {
  const patch::Submap& submap = way.map.submaps[way.submap];
  const auto is_near = [&](const WayPoint& point) {
    return patch::distance_m(point.truth.translation(), submap.rect, way.map.base.resolution_m()) <=
           way.map.entry_margin_m;
  };
  const auto first = std::find_if(way.points.begin(), way.points.end(), is_near);
  const auto after = std::find_if_not(first, way.points.end(), is_near);
  if (first == way.points.end() || after == way.points.end()) return std::nullopt;
  const double from_s = first->time_s - kAroundWay_s;
  const double to_s = (after - 1)->time_s + kAroundWay_s;
  const auto begin = std::find_if(way.points.begin(), first,
                                  [&](const WayPoint& point) { return point.time_s >= from_s; });
  const auto end = std::find_if(after, way.points.end(),
                                [&](const WayPoint& point) { return point.time_s > to_s; });
  way.entered = static_cast<std::size_t>(first - begin);
  way.left = static_cast<std::size_t>(after - 1 - begin);
  way.points = std::vector<WayPoint>(begin, end);
  return way;
}

}  // namespace

double WayThrough::error_m() const {
  double sum_m = 0.0;
  for (std::size_t i = entered; i <= left; ++i) {
    sum_m += translation_distance(points[i].found, points[i].truth);
  }
  return sum_m / static_cast<double>(left - entered + 1);
}

std::optional<WayThrough> way_through_box(const std::string& scenario, std::uint64_t seed,
                                          const std::string& model) {
  simulate::ScenarioConfig config = simulate::load_scenario(scenario);
  config.laser.field_of_view_deg = 360.0;
  config.laser.beams = 360;
  const simulate::Simulation simulation = simulate::simulate(config, seed);
  const int last = static_cast<int>(simulation.days.size());
  const std::vector<PosedScan> learned = noisy_scans(simulation, {}, seed, 1, last - 1);
  const StaticMaps maps = static_maps(learned);
  const auto patches =
      std::make_shared<const patch::PatchMap>(learn_patches(learned, maps.filtered));
  const TrueConfigurations truth = true_configurations(simulation, *patches, simulation, last);
  const auto known = std::find_if(truth.begin(), truth.end(), [](const auto& configuration) {
    return configuration.has_value();
  });
  if (known == truth.end()) return std::nullopt;
  WayThrough way;
  way.map = *patches;
  way.submap = static_cast<std::size_t>(known - truth.begin());
  way.true_configuration = **known;
  const auto& scans = simulation.days.back().scans;
  localization::Localizer localizer({}, model_named(model, maps, patches), seed, 2);
  localizer.initialize(
      {scans.front().map_from_robot, Eigen::Vector3d(0.01, 0.01, 0.0025).asDiagonal()});
  const Stamp begin = scans.front().observation.scan.stamp;
  for (const simulate::SimulatedScan& scan : scans) {
    const localization::LocalizationResult result = localizer.update(scan.observation);
    way.points.push_back({(scan.observation.scan.stamp - begin).seconds(), result.pose.mean,
                          scan.map_from_robot, result.submaps[way.submap].probability});
  }
  return cut(std::move(way));
}

}  // namespace strata::experiments
