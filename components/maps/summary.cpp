// SPDX-License-Identifier: Apache-2.0
#include "components/maps/summary.hpp"

#include <algorithm>
#include <cstddef>
#include <iomanip>
#include <set>
#include <sstream>
#include <string>

#include "core/grid/map_sharpness.hpp"

namespace strata::maps {
namespace {

using nlohmann::json;

constexpr double kMinStep_m = 0.1;

struct RunExtent {
  double duration_s = 0.0;
  double path_m = 0.0;
  std::size_t runs = 0;
};

RunExtent extent_of(const std::vector<PosedScan>& scans) {
  RunExtent extent;
  std::set<int> runs;
  const PosedScan* previous = nullptr;
  Pose2 counted;
  for (const PosedScan& scan : scans) {
    if (runs.insert(scan.run).second) {
      counted = scan.map_from_robot;
    } else {
      extent.duration_s += (scan.scan.stamp - previous->scan.stamp).seconds();
    }
    if (const double step_m = translation_distance(counted, scan.map_from_robot);
        step_m >= kMinStep_m) {
      extent.path_m += step_m;
      counted = scan.map_from_robot;
    }
    previous = &scan;
  }
  extent.runs = runs.size();
  return extent;
}

json summarize(const slam::Consistency& consistency) {
  json places = json::array();
  for (const slam::ComparedStretches& place : consistency.places) {
    std::ostringstream why;
    why << std::fixed << std::setprecision(1) << "seen at " << place.first.seconds() << " s of run "
        << place.first_run << " and at " << place.second.seconds() << " s of run "
        << place.second_run << ": " << std::setprecision(0) << 100.0 * place.share
        << "% of the surfaces that one saw are free by the other";
    places.push_back({{"x", place.x_m}, {"y", place.y_m}, {"why", why.str()}});
  }
  return {{"consistent", consistency.consistent},
          {"compared", consistency.compared},
          {"contradicting", consistency.contradicting},
          {"runs_against_others", consistency.against_others},
          {"places", places}};
}

}  // namespace

json summarize_slam(const slam::SlamResult& result) {
  const RunExtent extent = extent_of(result.scans);
  const MapSharpness sharpness = map_sharpness(result.occupancy);
  return {{"scans", result.scans.size()},
          {"skipped_scans", result.skipped_scans},
          {"duration_s", extent.duration_s},
          {"path_m", extent.path_m},
          {"runs", extent.runs},
          {"consistency", summarize(result.consistency)},
          {"drop_outs",
           {{"judged", result.drop_outs.no_returns},
            {"dropped", result.drop_outs.dropped},
            {"returned", result.drop_outs.returned},
            {"free_range_m", result.drop_outs.free_range_m}}},
          {"sharpness",
           {{"entropy_bits", sharpness.entropy_bits},
            {"wall_thickness_m", sharpness.wall_thickness_m}}},
          {"em",
           {{"iterations", result.iterations},
            {"log_likelihood", result.log_likelihood},
            {"dynamic_fraction", result.dynamic_fraction}}}};
}

namespace {

json corners_m(const CellRect& rect, double resolution_m) {
  return {rect.min.x * resolution_m, rect.min.y * resolution_m, rect.max.x * resolution_m,
          rect.max.y * resolution_m};
}

}  // namespace

json summarize_unrecurring(const patch::PatchMap& map) {
  json areas = json::array();
  for (const CellRect& rect : map.unrecurring) {
    areas.push_back(corners_m(rect, map.base.resolution_m()));
  }
  return areas;
}

json summarize_patch_map(const patch::PatchMap& map) {
  json submaps = json::array();
  const double resolution_m = map.base.resolution_m();
  for (const patch::Submap& submap : map.submaps) {
    // Members: the sequences of each configuration, by their largest membership.
    std::vector<std::size_t> members(submap.configurations.size(), 0);
    for (const patch::SequenceInfo& sequence : submap.sequences) {
      const auto best = std::max_element(sequence.membership.begin(), sequence.membership.end());
      if (best != sequence.membership.end()) {
        ++members[static_cast<std::size_t>(best - sequence.membership.begin())];
      }
    }
    const CellRect& rect = submap.rect;
    submaps.push_back({{"id", submap.id},
                       {"rect", corners_m(rect, resolution_m)},
                       {"area_m2", static_cast<double>(rect.area()) * resolution_m * resolution_m},
                       {"sequences", submap.sequences.size()},
                       {"configurations", submap.configurations.size()},
                       {"members", members}});
  }
  return submaps;
}

json summarize_timescale(const memory::TimescaleMemory& memory) {
  json levels = json::array();
  for (const memory::LevelConfig& level : memory.config().levels) {
    levels.push_back({{"name", level.name},
                      {"half_life", level.nominal_half_life_s()},
                      {"samples_per_bin", level.samples}});
  }
  return {{"levels", levels},
          {"nodes", memory.nodes().size()},
          {"observations", memory.observations()},
          {"bytes", memory.bytes()}};
}

json summarize_no_returns(const log::ReadReport& report) {
  json limits = json::array();
  for (const log::NoReturnLimit& limit : report.no_returns) {
    json entry{{"from_m", limit.from_m}, {"why", limit.why}};
    if (!limit.scanner.empty()) entry["scanner"] = limit.scanner;
    limits.push_back(entry);
  }
  return limits;
}

json summarize_reading(std::span<const log::ReadReport> reports) {
  json no_return = json::array();
  json lags = json::array();
  for (const log::ReadReport& report : reports) {
    for (const json& limit : summarize_no_returns(report)) no_return.push_back(limit);
    lags.push_back(report.clock.lag_s ? json(*report.clock.lag_s) : json(nullptr));
  }
  return {{"no_return", no_return}, {"odometry_lag_s", lags.size() == 1 ? lags[0] : lags}};
}

}  // namespace strata::maps
