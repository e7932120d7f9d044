// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "tools/laboratory/paper/building_topology.hpp"
#include "tools/laboratory/paper/figures.hpp"

namespace strata::paper {
namespace {

/// Judged: the only log of another building with odometry of its own. The others are key scans with
/// invented odometry, true to decimetres; they stand beside it.
Building csail() { return {"MIT CSAIL", "csail/csail.clf.gz", "csail/csail.ref.txt", 0.05}; }

std::vector<Building> radish() {
  std::vector<Building> all;
  for (const char* name : {"acapulco", "belgioioso", "freiburg-101", "seattle"}) {
    const std::string folder = std::string("radish/") + name;
    all.push_back({name, folder + "/log.clf.gz", folder + "/truth.tum", 0.1});
  }
  return all;
}

/// The same of each other building: pairs together, errors of maps one by one.
void add_others(const Setting& setting, const std::string& id, bool judges_map,
                std::vector<Number>& numbers, std::vector<Picture>& pictures) {
  pipeline::TopologyAgreement together;
  int held = 0;
  const std::vector<Building> all = radish();
  for (const Building& building : all) {
    const BuildingTopology other = topology_of(setting, building);
    held += is_true(other.pairs) && (!judges_map || is_consistent(other)) ? 1 : 0;
    together.near += other.pairs.near;
    together.near_merged += other.pairs.near_merged;
    together.far += other.pairs.far;
    together.far_merged += other.pairs.far_merged;
    if (judges_map) {
      numbers.push_back({"the same, " + building.name + " [m]", {}, other.error_m, 3});
    }
    for (Picture& picture : picture_of(other, judges_map ? "map.png" : "landmarks.png",
                                       id + "_" + building.name, building.name)) {
      pictures.push_back(std::move(picture));
    }
  }
  const auto real = [](std::size_t count) { return static_cast<double>(count); };
  const std::string others = std::to_string(all.size()) + " other buildings: ";
  numbers.push_back({others + "pairs within 1 m", {}, real(together.near), 0});
  numbers.push_back({"of them one landmark", {}, real(together.near_merged), 0});
  numbers.push_back({others + "pairs more than 2 m apart", {}, real(together.far), 0});
  numbers.push_back({"of them one landmark", {}, real(together.far_merged), 0});
  numbers.push_back({others + "in which it holds", {}, static_cast<double>(held), 0});
}

Outcome second_building(const Setting& setting, const std::string& id, bool judges_map) {
  const BuildingTopology building = topology_of(setting, csail());
  std::vector<Number> numbers = numbers_of(building);
  if (judges_map) {
    numbers.push_back({"mean pose error after alignment [m]", {}, building.error_m, 3});
  }
  std::vector<Picture> pictures =
      picture_of(building, judges_map ? "map.png" : "landmarks.png", id, csail().name);
  add_others(setting, id, judges_map, numbers, pictures);
  const bool is_right = is_true(building.pairs);
  return judged(is_right && (!judges_map || is_consistent(building)),
                is_right ? "poses in the map are too far from the true ones"
                         : "places apart are taken for one, or too many revisits for new places",
                std::move(numbers), std::move(pictures));
}

}  // namespace

std::vector<Figure> ptm_building_figures() {
  const char* const material =
      "the real log of MIT CSAIL; beside it four logs of the Radish collection, whose odometry is "
      "invented";
  return {
      {"ptm-9", "ptm", "Metric map, experiment 2", "it is consistent.", "as ptm-7, in MIT CSAIL.",
       material, [](const Setting& s) { return second_building(s, "ptm-9", true); }, ""},
      {"ptm-11", "ptm", "The likeliest sample, experiment 2", "it is near the truth.",
       "as ptm-4, in MIT CSAIL.", material,
       [](const Setting& s) { return second_building(s, "ptm-11", false); }, ""}};
}

}  // namespace strata::paper
