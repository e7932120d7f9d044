// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <fstream>
#include <sstream>
#include <tuple>

#include <unistd.h>

#include "tools/laboratory/paper/figures.hpp"
#include "tools/laboratory/paper/pose_error.hpp"
#include "tools/pipeline/runs_input.hpp"
#include "tools/pipeline/topology.hpp"
#include "tools/pipeline/topology_files.hpp"

namespace strata::paper {
namespace {

constexpr double kPrecision_m = 0.05;
constexpr double kNear_m = 1.0;
constexpr double kConsistent_m = 0.5;

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream bytes;
  bytes << in.rdbuf();
  return bytes.str();
}

/// One of the pictures of `strata topology`; nothing where it cannot be drawn.
std::vector<Picture> pictures_of(const pipeline::TopologyMap& map, const std::string& id,
                                 const std::string& picture) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("strata_" + id + "_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  report::Drawings drawings;
  pipeline::write_topology_pictures(folder, map, drawings);
  std::string bytes = bytes_of(folder / picture);
  std::filesystem::remove_all(folder);
  if (bytes.empty()) return {};
  return {{id, picture + " of Freiburg 079", std::move(bytes)}};
}

/// What is made of the topology of Freiburg 079.
struct TopologyFigure {
  std::string id;
  std::string picture;
  bool match_scans = true;
  bool judges_map = false;  ///< the poses of its scans count, too
};

Outcome topology(const Setting& setting, const TopologyFigure& figure) {
  pipeline::RunsInput input;
  input.logs = {data_file(setting, "fr079/fr079.clf.gz")};
  input.truths = {data_file(setting, "fr079/fr079.ref.txt")};
  const pipeline::Runs runs = pipeline::read_runs(input, nullptr);
  topology::TopologyMapperConfig config;
  config.match_scans = figure.match_scans;
  const pipeline::TopologyMap map = pipeline::map_topology(
      runs.observations, {}, std::nullopt, config, setting.first_seed, setting.threads, nullptr);
  const auto pairs = pipeline::agreement(map, map.posterior.front(), runs.observations, runs.truths,
                                         kNear_m, kPrecision_m);
  const auto real = [](std::size_t count) { return static_cast<double>(count); };
  std::vector<Number> numbers{
      {"visits", {}, real(map.visits.size()), 0},
      {"pairs within 1 m", {}, real(pairs.near), 0},
      {"of them one landmark", {}, real(pairs.near_merged), 0},
      {"pairs more than 2 m apart", {}, real(pairs.far), 0},
      {"of them one landmark", {}, real(pairs.far_merged), 0},
      {"probability of the likeliest topology", {}, map.posterior.front().probability, 3}};
  const bool is_true =
      pairs.near > 0 && pairs.far_merged == 0 && 10 * pairs.near_merged >= 9 * pairs.near;
  bool is_consistent = true;
  if (figure.judges_map) {
    const double error_m = pose_error_m(map.scans, stamped_truth(runs));
    is_consistent = error_m <= kConsistent_m;
    numbers.push_back({"mean pose error after alignment [m]", {}, error_m, 3});
  }
  return judged(is_true && is_consistent,
                is_true ? "poses in the map are too far from the true ones"
                        : "places apart are taken for one, or too many revisits for new places",
                std::move(numbers), pictures_of(map, figure.id, figure.picture));
}

}  // namespace

std::vector<Figure> ptm_figures() {
  const char* const truth =
      "no pair of places 2 m apart is one landmark, and at least 90% of those within 1 m are.";
  const char* const log = "the real log fr079; the paper's own logs are not public here";
  const auto by = [](const TopologyFigure& figure) {
    return [=](const Setting& s) { return topology(s, figure); };
  };
  std::vector<Figure> all{
      {"ptm-4", "ptm", "The likeliest sample with its landmarks", "it is the truth.", truth, log,
       by({"ptm-4", "landmarks.png"}), ""},
      {"ptm-6", "ptm", "Raw odometry only", "odometry alone does not close; the topology does.",
       truth, "the real log fr079 without scan matching between visits",
       by({"ptm-6", "odometry.png", false}), ""},
      {"ptm-7", "ptm", "The metric map of the topology", "it is consistent.",
       "as ptm-4, and the mean pose error after alignment is at most 0.5 m.", log,
       by({"ptm-7", "map.png", true, true}), ""}};
  constexpr std::array<std::tuple<const char*, const char*, const char*, const char*>, 2> kMissing{
      {{"ptm-mass-1", "Mass of the truth, experiment 1", "the truth has 94%.",
        "its worlds are part of the tests (topology_figures), not of the laboratory; at laser "
        "level it was never run"},
       {"ptm-10", "Mass of the truth, experiment 2", "the truth has 82% or 89%.",
        "as ptm-mass-1"}}};
  for (const auto& [id, title, shows, why] : kMissing) {
    all.push_back({id, "ptm", title, shows, "not fixed yet.", "nothing yet", nullptr, why});
  }
  return all;
}

}  // namespace strata::paper
