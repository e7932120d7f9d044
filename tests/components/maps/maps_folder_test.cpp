// SPDX-License-Identifier: Apache-2.0
#include "components/maps/maps_folder.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/log/map_file.hpp"
#include "components/log/trajectory_file.hpp"
#include "core/base/error.hpp"
#include "core/slam/learned_surfaces.hpp"
#include "memory/store/store.hpp"
#include "tests/components/maps/learned_room.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/test_data.hpp"

namespace strata::maps {
namespace {

using strata::test::same_bits;

using nlohmann::json;
using test::TemporaryDirectory;

json read_json(const std::filesystem::path& path) {
  std::ifstream in(path);
  return json::parse(in);
}

TEST(MapsFolder, GivesEveryPartBackBitForBit) {
  const TemporaryDirectory dir;
  slam::SlamResult slam = test_room::make_slam_result();
  const patch::PatchMap patches = test_room::make_patch_map(slam);
  const auto memory = test_room::make_memory(slam);
  ASSERT_FALSE(memory->nodes().empty());
  slam.surfaces = slam::learned_surfaces(slam.scans, slam.filtered.resolution_m());
  ASSERT_GT(slam.surfaces.cells.size(), 50U);
  write_grid_maps(dir.path(), slam);
  write_patch_map(dir.path(), patches);
  write_timescale(dir.path(), *memory);
  const Pose2 map_from_truth{1.5, -0.1, 2.0 / 3.0};
  write_map_from_truth(dir.path(), map_from_truth);

  const Maps maps = read_maps(dir.path());
  EXPECT_TRUE(same_bits(maps.occupancy, slam.occupancy));
  EXPECT_TRUE(same_bits(maps.filtered, slam.filtered));
  EXPECT_EQ(maps.surfaces.cells, slam.surfaces.cells);
  ASSERT_TRUE(maps.map_from_truth.has_value());
  EXPECT_EQ(*maps.map_from_truth, map_from_truth);
  ASSERT_TRUE(maps.visit_scans);
  std::size_t scans = 0;
  maps.visit_scans([&](const PosedScan& scan) {
    EXPECT_EQ(scan.map_from_robot, slam.scans.at(scans).map_from_robot);
    EXPECT_EQ(scan.scan.stamp, slam.scans.at(scans++).scan.stamp);
  });
  EXPECT_EQ(scans, slam.scans.size());
  ASSERT_NE(maps.timescale, nullptr);
  EXPECT_EQ(maps.timescale->state(), memory->state());
  ASSERT_TRUE(maps.patches.has_value());
  EXPECT_TRUE(same_bits(maps.patches->base, patches.base));
  ASSERT_EQ(maps.patches->submaps.size(), 1U);
  const patch::Submap& submap = maps.patches->submaps[0];
  EXPECT_EQ(submap.rect, patches.submaps[0].rect);
  ASSERT_EQ(submap.configurations.size(), 2U);
  for (std::size_t c = 0; c < 2; ++c) {
    const patch::Configuration& expected = patches.submaps[0].configurations[c];
    EXPECT_TRUE(same_bits(submap.configurations[c].counts, expected.counts));
    EXPECT_TRUE(same_bits(submap.configurations[c].reflection, expected.reflection));
    EXPECT_EQ(submap.configurations[c].prior, expected.prior);
  }
  ASSERT_EQ(submap.sequences.size(), 3U);
  EXPECT_EQ(submap.sequences[2].membership, (std::vector<double>{0.3, 0.7}));
}

TEST(MapsFolder, KeepsEveryScanOfRunsThatTakeTurns) {
  const TemporaryDirectory dir;
  slam::SlamResult slam = test_room::make_slam_result();
  ASSERT_GT(slam.scans.size(), 4U);
  for (std::size_t i = 0; i < slam.scans.size(); ++i) slam.scans[i].run = static_cast<int>(i % 2);
  write_grid_maps(dir.path(), slam);
  const memory::Store store = open_for_reading(dir.path());
  EXPECT_EQ(store.load_scans(0).size() + store.load_scans(1).size(), slam.scans.size());
}

TEST(MapsFolder, LeavesMapServerFilesThatSayTheSame) {
  const TemporaryDirectory dir;
  const slam::SlamResult slam = test_room::make_slam_result();
  write_grid_maps(dir.path(), slam);
  write_patch_map(dir.path(), test_room::make_patch_map(slam));

  const ReflectionGrid filtered = log::read_map(dir.path() / "filtered.yaml");
  for (std::size_t i = 0; i < slam.filtered.size(); ++i) {
    const float learned = slam.filtered.values()[i];
    const float read = filtered.get(slam.filtered.cell(i));
    ASSERT_EQ(is_known(read) && is_occupied(read), is_known(learned) && is_occupied(learned)) << i;
  }
  // The likeliest configuration is the one with the box.
  const Cell inside_box{50, 0};
  EXPECT_TRUE(is_occupied(log::read_map(dir.path() / "patches.yaml").get(inside_box)));
  const auto folder = dir.path() / "patches";
  EXPECT_TRUE(is_free(log::read_map(folder / "submap0_configuration0.yaml").get(inside_box)));
  EXPECT_TRUE(is_occupied(log::read_map(folder / "submap0_configuration1.yaml").get(inside_box)));
}

TEST(MapsFolder, KeepsTheTrajectoryOfEachRun) {
  const TemporaryDirectory dir;
  const slam::SlamResult slam = test_room::make_slam_result();
  write_grid_maps(dir.path(), slam);
  const auto poses = log::read_trajectory(dir.path() / kTrajectoryFile);
  ASSERT_EQ(poses.size(), slam.scans.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].stamp, slam.scans[i].scan.stamp);
    EXPECT_NEAR(poses[i].pose.x, slam.scans[i].map_from_robot.x, 1e-9);
    EXPECT_NEAR(poses[i].pose.theta, slam.scans[i].map_from_robot.theta, 1e-8);
  }
  const memory::Store store(dir.path() / kStoreFile, {.read_only = true});
  EXPECT_EQ(store.runs(), (std::vector<int>{0, 1}));
  const auto second = store.load_trajectory(1);
  ASSERT_EQ(second.size(), static_cast<std::size_t>(test_room::kScansARun));
  EXPECT_EQ(second[2].map_from_robot, slam.scans[test_room::kScansARun + 2].map_from_robot);
}

TEST(MapsFolder, HoldsOnlyThePartsThatWereLearned) {
  const TemporaryDirectory dir;
  write_grid_maps(dir.path(), test_room::make_slam_result());
  const Maps maps = read_maps(dir.path());
  EXPECT_GT(maps.filtered.size(), 0U);
  EXPECT_FALSE(maps.patches.has_value());
  EXPECT_EQ(maps.timescale, nullptr);
  EXPECT_FALSE(maps.map_from_truth.has_value());
}

TEST(MapsFolder, RefusesAFolderWithoutAStoreOrWithADamagedOne) {
  const TemporaryDirectory dir;
  EXPECT_THROW(static_cast<void>(read_maps(dir.path())), InputError);
  std::ofstream(dir.path() / kStoreFile) << "this is no database, however long it goes on";
  EXPECT_THROW(static_cast<void>(read_maps(dir.path())), InputError);
}

TEST(MapsFolder, CannotBeWrittenWhereAFileStands) {
  const TemporaryDirectory dir;
  std::ofstream(dir.path() / "file") << "in the way";
  EXPECT_THROW(write_grid_maps(dir.path() / "file", test_room::make_slam_result()), OutputError);
}

TEST(MapsSummary, TellsOfEachPartOnceItIsThere) {
  const TemporaryDirectory dir;
  const slam::SlamResult slam = test_room::make_slam_result();
  write_grid_maps(dir.path(), slam);
  const json grids_only = write_summary(dir.path(), "week.clf", {4.0, 6.0, 50.0});
  EXPECT_EQ(grids_only["log"], "week.clf");
  EXPECT_EQ(grids_only["scans"], 12);
  EXPECT_EQ(grids_only["skipped_scans"], 3);
  EXPECT_EQ(grids_only["runs"], 2);
  // Five seconds and five steps a run; what lies between the runs does not count.
  EXPECT_DOUBLE_EQ(grids_only["duration_s"], 10.0);
  EXPECT_NEAR(grids_only["path_m"].get<double>(), 10.0 * test_room::kStep_m, 1e-12);
  EXPECT_EQ(grids_only["em"]["iterations"], 2);
  EXPECT_EQ(grids_only["em"]["log_likelihood"], json({-1234.5, -1000.25}));
  EXPECT_EQ(grids_only["em"]["dynamic_fraction"], 0.125);
  EXPECT_DOUBLE_EQ(grids_only["cost"]["real_time_factor"], 2.5);
  EXPECT_EQ(grids_only["submaps"], json::array());
  EXPECT_TRUE(grids_only["timescale"].is_null());

  EXPECT_EQ(grids_only["unrecurring"], json::array());

  patch::PatchMap patches = test_room::make_patch_map(slam);
  patches.unrecurring.push_back({{20, -10}, {40, 30}});
  write_patch_map(dir.path(), patches);
  const json with_patches = write_summary(dir.path(), "week.clf", {});
  const double cell_m = patches.base.resolution_m();
  EXPECT_EQ(with_patches["unrecurring"],
            json::array({json({20 * cell_m, -10 * cell_m, 40 * cell_m, 30 * cell_m})}));
  ASSERT_EQ(with_patches["submaps"].size(), 1U);
  const json& submap = with_patches["submaps"][0];
  EXPECT_EQ(submap["id"], 0);
  EXPECT_NEAR(submap["rect"][0].get<double>(), 1.8, 1e-12);
  EXPECT_NEAR(submap["rect"][3].get<double>(), 1.2, 1e-12);
  EXPECT_NEAR(submap["area_m2"].get<double>(), 1.4 * 2.4, 1e-12);
  EXPECT_EQ(submap["sequences"], 3);
  EXPECT_EQ(submap["configurations"], 2);
  EXPECT_EQ(submap["members"], json({1, 2}));
  EXPECT_TRUE(with_patches["timescale"].is_null());
  EXPECT_EQ(with_patches["em"], grids_only["em"]);
  EXPECT_EQ(with_patches["cost"]["real_time_factor"], 0.0);

  const auto memory = test_room::make_memory(slam);
  write_timescale(dir.path(), *memory);
  const json whole = write_summary(dir.path(), "week.clf", {});
  EXPECT_EQ(whole["timescale"]["nodes"], memory->nodes().size());
  EXPECT_EQ(whole["timescale"]["observations"], memory->observations());
  EXPECT_EQ(whole["timescale"]["bytes"], memory->bytes());
  ASSERT_EQ(whole["timescale"]["levels"].size(), 3U);
  EXPECT_EQ(whole["timescale"]["levels"][1]["name"], "mid");
  EXPECT_EQ(whole["timescale"]["levels"][1]["half_life"], 27.0);
  EXPECT_EQ(whole["timescale"]["levels"][1]["samples_per_bin"], 20);
  EXPECT_EQ(whole["submaps"], with_patches["submaps"]);
  EXPECT_EQ(read_json(dir.path() / kSummaryFile), whole);
}

TEST(MapsSummary, DoesNotDependOnTheOrderOfTheParts) {
  const TemporaryDirectory one;
  const TemporaryDirectory other;
  const slam::SlamResult slam = test_room::make_slam_result();
  const patch::PatchMap patches = test_room::make_patch_map(slam);
  const auto memory = test_room::make_memory(slam);
  write_grid_maps(one.path(), slam);
  write_patch_map(one.path(), patches);
  write_timescale(one.path(), *memory);
  write_timescale(other.path(), *memory);
  write_patch_map(other.path(), patches);
  write_grid_maps(other.path(), slam);
  EXPECT_EQ(write_summary(one.path(), "log", {}), write_summary(other.path(), "log", {}));
}

}  // namespace
}  // namespace strata::maps
