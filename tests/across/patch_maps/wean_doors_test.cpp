// SPDX-License-Identifier: Apache-2.0
// Three real runs in one building whose doors changed in between: few visits, doors seen from afar.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "components/log/log_reader.hpp"
#include "components/log/trajectory_file.hpp"
#include "core/patch/patch_learner.hpp"
#include "core/slam/slam.hpp"
#include "tests/support/test_data.hpp"

namespace strata {
namespace {

// The doors of the data's README, map frame; all were open in run 2 and closed in run 1.
const std::vector<Eigen::Vector2d> kDoors{
    {27.9, 42.6}, {29.5, 39.6}, {49.4, 37.8}, {51.6, 37.6}, {52.5, 40.4}};
// The table is measured at reference poses, good to 0.1 m across and 0.3 m along the corridor.
constexpr double kNear_m = 0.5;

void add_run(const std::filesystem::path& folder, int run, slam::Slam& slam) {
  const std::string name = "run" + std::to_string(run);
  const auto poses = log::read_trajectory(folder / (name + ".ref.txt"));
  log::ReadOptions options;
  options.run = run;
  for (const Observation& o : log::read_observations(folder / (name + ".clf.gz"), options)) {
    const auto nearest = std::min_element(poses.begin(), poses.end(), [&](auto& a, auto& b) {
      return std::abs((a.stamp - o.scan.stamp).ns) < std::abs((b.stamp - o.scan.stamp).ns);
    });
    slam.add(o, &nearest->pose);
  }
}

/// The contradictory cells of a sub-map near a door.
std::vector<Cell> cells_near(const patch::Submap& submap, const Eigen::Vector2d& door) {
  std::vector<Cell> cells;
  const Grid<std::uint8_t>& mask = submap.contradictory;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask.values()[i] == 0) continue;
    if ((mask.center(mask.cell(i)) - door).norm() < kNear_m) cells.push_back(mask.cell(i));
  }
  return cells;
}

/// Whether a configuration holds a surface in the 3 x 3 block of a cell.
bool is_occupied_near(const ReflectionGrid& grid, const Cell& cell) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const float m = grid.get({cell.x + dx, cell.y + dy});
      if (is_known(m) && is_occupied(m)) return true;
    }
  }
  return false;
}

/// Whether two configurations show the door in two states: more than four fifths of the cells that
/// changed are occupied in one and not in the other. Which one differs by cell: the leaf of a door
/// fills the frame when closed and stands beside it when open.
bool shows_both_states(const patch::Submap& submap, const std::vector<Cell>& cells) {
  for (const patch::Configuration& a : submap.configurations) {
    for (const patch::Configuration& b : submap.configurations) {
      const auto differ = std::count_if(cells.begin(), cells.end(), [&](const Cell& cell) {
        return is_occupied_near(a.reflection, cell) != is_occupied_near(b.reflection, cell);
      });
      if (static_cast<double>(differ) > 0.8 * static_cast<double>(cells.size())) return true;
    }
  }
  return false;
}

TEST(WeanHall, SubmapsHoldAtLeastFourDoorsInBothStatesAndFewOtherPlaces) {
  STRATA_REQUIRE_DATA(folder, "wean_hall");
  slam::Slam slam({}, 2);
  for (int run = 1; run <= 3; ++run) add_run(folder, run, slam);
  slam::SlamResult mapped = slam.finish();
  patch::PatchLearner learner({}, 2);
  for (PosedScan& scan : mapped.scans) learner.add(std::move(scan));
  const patch::PatchMap map = learner.finish(mapped.filtered);

  int doors = 0;
  std::vector<bool> has_door(map.submaps.size(), false);
  for (const Eigen::Vector2d& door : kDoors) {
    bool found = false;
    for (const patch::Submap& submap : map.submaps) {
      const std::vector<Cell> cells = cells_near(submap, door);
      if (cells.empty() || !shows_both_states(submap, cells)) continue;
      has_door[static_cast<std::size_t>(submap.id)] = true;
      found = true;
    }
    doors += found ? 1 : 0;
  }
  EXPECT_GE(doors, 4);
  // The furniture of one open room takes two of them.
  EXPECT_LE(std::count(has_door.begin(), has_door.end(), false), 3) << "places without a door";
}

}  // namespace
}  // namespace strata
