// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <utility>
#include <vector>

#include "tools/laboratory/paper/building_topology.hpp"
#include "tools/laboratory/paper/figures.hpp"

namespace strata::paper {
namespace {

/// What is made of the topology of Freiburg 079.
struct TopologyFigure {
  std::string id;
  std::string picture;
  bool match_scans = true;
  bool judges_map = false;  ///< the poses of its scans count, too
};

Outcome topology(const Setting& setting, const TopologyFigure& figure) {
  const BuildingTopology building = topology_of(setting, freiburg_079(), figure.match_scans);
  std::vector<Number> numbers = numbers_of(building);
  if (figure.judges_map) {
    numbers.push_back({"mean pose error after alignment [m]", {}, building.error_m, 3});
  }
  const bool is_right = is_true(building.pairs);
  return judged(
      is_right && (!figure.judges_map || is_consistent(building)),
      is_right ? "poses in the map are too far from the true ones"
               : "places apart are taken for one, or too many revisits for new places",
      std::move(numbers),
      picture_of(building, figure.picture, figure.id, figure.picture + " of Freiburg 079"));
}

}  // namespace

std::vector<Figure> ptm_figures() {
  const char* const truth =
      "no pair of places 2 m apart is one landmark, and at least 90% of those within 1 m are.";
  const char* const log = "the real log fr079; the paper's own logs are not public here";
  const auto by = [](const TopologyFigure& figure) {
    return [=](const Setting& s) { return topology(s, figure); };
  };
  return {{"ptm-4", "ptm", "The likeliest sample with its landmarks", "it is the truth.", truth,
           log, by({"ptm-4", "landmarks.png"}), ""},
          {"ptm-6", "ptm", "Raw odometry only", "odometry alone does not close; the topology does.",
           truth, "the real log fr079 without scan matching between visits",
           by({"ptm-6", "odometry.png", false}), ""},
          {"ptm-7", "ptm", "The metric map of the topology", "it is consistent.",
           "as ptm-4, and the mean pose error after alignment is at most 0.5 m.", log,
           by({"ptm-7", "map.png", true, true}), ""}};
}

}  // namespace strata::paper
