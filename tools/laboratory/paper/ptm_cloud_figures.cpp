// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/paper/building_topology.hpp"
#include "tools/laboratory/paper/figures.hpp"
#include "tools/laboratory/paper/landmark_clouds.hpp"

namespace strata::paper {
namespace {

Outcome local_clouds(const Setting& setting) {
  const BuildingTopology building = topology_of(setting, freiburg_079());
  const topology::Hypothesis& likeliest = building.map.posterior.front();
  const CloudAgreement clouds = cloud_agreement(building.map.visits, likeliest);
  const auto real = [](std::size_t count) { return static_cast<double>(count); };
  const bool has_all = clouds.with_cloud == clouds.landmarks;
  return judged(has_all && clouds.pairs > 0 && 10 * clouds.overlapping >= 9 * clouds.pairs,
                has_all ? "clouds of one landmark do not lie on each other"
                        : "a landmark has a visit without a cloud",
                {{"landmarks", {}, real(clouds.landmarks), 0},
                 {"with a cloud at every visit", {}, real(clouds.with_cloud), 0},
                 {"pairs of visits of one landmark", {}, real(clouds.pairs), 0},
                 {"of them with clouds that overlap", {}, real(clouds.overlapping), 0},
                 {"pairs of different landmarks, laid on each other", {}, real(clouds.others), 0},
                 {"of them with clouds that overlap", {}, real(clouds.others_overlapping), 0}},
                picture_of(draw_clouds(building.map.visits, likeliest), "ptm-1",
                           "a tile a landmark, 12 m across, a colour a visit; Freiburg 079"));
}

}  // namespace

std::vector<Figure> ptm_cloud_figures() {
  return {{"ptm-1", "ptm", "Local clouds of the landmarks", "each place has a patch.",
           "every visit has a cloud, and of at least 90% of the pairs of visits of one landmark "
           "half of the smaller cloud lies within 0.2 m of the other at the poses of the likeliest "
           "topology.",
           "the real log fr079; the paper's own logs are not public here", local_clouds, ""}};
}

}  // namespace strata::paper
