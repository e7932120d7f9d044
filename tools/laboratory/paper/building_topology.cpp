// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/paper/building_topology.hpp"

#include <filesystem>
#include <utility>

#include <unistd.h>

#include "components/log/whole_file.hpp"
#include "tools/laboratory/paper/pose_error.hpp"
#include "tools/pipeline/topology_files.hpp"
#include "tools/report/drawings.hpp"

namespace strata::paper {
namespace {

constexpr double kNear_m = 1.0;
constexpr double kConsistent_m = 0.5;

}  // namespace

Building freiburg_079() { return {"Freiburg 079", "fr079/fr079.clf.gz", "fr079/fr079.ref.txt"}; }

BuildingTopology topology_of(const Setting& setting, const Building& building, bool match_scans) {
  pipeline::RunsInput input;
  input.logs = {data_file(setting, building.log)};
  input.truths = {data_file(setting, building.truth)};
  const pipeline::Runs runs = pipeline::read_runs(input, nullptr);
  topology::TopologyMapperConfig config;
  config.match_scans = match_scans;
  BuildingTopology result;
  result.map = pipeline::map_topology(runs.observations, {}, std::nullopt, config,
                                      setting.first_seed, setting.threads, nullptr);
  result.pairs = pipeline::agreement(result.map, result.map.posterior.front(), runs.observations,
                                     runs.truths, kNear_m, building.precision_m);
  result.error_m = pose_error_m(result.map.scans, stamped_truth(runs));
  return result;
}

bool is_true(const pipeline::TopologyAgreement& pairs) {
  return pairs.near > 0 && pairs.far_merged == 0 && 10 * pairs.near_merged >= 9 * pairs.near;
}

bool is_consistent(const BuildingTopology& topology) { return topology.error_m <= kConsistent_m; }

std::vector<Number> numbers_of(const BuildingTopology& topology) {
  const auto real = [](std::size_t count) { return static_cast<double>(count); };
  const pipeline::TopologyAgreement& pairs = topology.pairs;
  return {
      {"visits", {}, real(topology.map.visits.size()), 0},
      {"pairs within 1 m", {}, real(pairs.near), 0},
      {"of them one landmark", {}, real(pairs.near_merged), 0},
      {"pairs more than 2 m apart", {}, real(pairs.far), 0},
      {"of them one landmark", {}, real(pairs.far_merged), 0},
      {"probability of the likeliest topology", {}, topology.map.posterior.front().probability, 3}};
}

std::vector<Picture> picture_of(const BuildingTopology& topology, const std::string& file,
                                const std::string& name, const std::string& caption) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("strata_" + name + "_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  report::Drawings drawings;
  pipeline::write_topology_pictures(folder, topology.map, drawings);
  std::string bytes = log::read_whole_file(folder / file);
  std::filesystem::remove_all(folder);
  if (bytes.empty()) return {};
  return {{name, caption, std::move(bytes)}};
}

}  // namespace strata::paper
