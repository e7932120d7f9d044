// SPDX-License-Identifier: Apache-2.0
/// `strata simulate` and `strata volume` together: people in rooms, and what is left of them.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <octomap/ColorOcTree.h>

#include "components/log/map_file.hpp"
#include "components/log/trajectory_file.hpp"
#include "components/maps/map_model.hpp"
#include "core/volume/volume_map.hpp"
#include "tests/support/decoded_png.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/program.hpp"
#include "tools/pipeline/localization_metrics.hpp"
#include "tools/pipeline/localize.hpp"
#include "tools/pipeline/runs_input.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using test::quoted;
using test::run_strata;

nlohmann::json json_of(const fs::path& path) { return nlohmann::json::parse(std::ifstream(path)); }

/// One simulated drive for all tests. Few voxels outlive the rays of 44 clouds even unfiltered: how
/// many depends on who stood where at the end of a drive; in this one enough to judge by.
class VolumePeople : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryDirectory>();
    const auto outcome = run_strata("simulate '" STRATA_SOURCE_DIR
                                    "/tools/simulate/scenarios/room_people_3d.yaml' --seed 112 "
                                    "--quiet --out " +
                                    quoted(folder_->path() / "sim"));
    ASSERT_EQ(outcome.code, 0);
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static nlohmann::json volume(const std::string& name, const std::string& options) {
    const fs::path out = folder_->path() / name;
    const auto outcome = run_strata("volume " + quoted(folder_->path() / "sim" / "bag") +
                                    " --quiet --out " + quoted(out) + " " + options + " 2>&1");
    EXPECT_EQ(outcome.code, 0) << outcome.out;
    return outcome.code == 0 ? json_of(out / "summary.json") : nlohmann::json{};
  }
  /// How many voxels of map_color.ot have a colour like this.
  template <typename Like>
  static std::size_t colored(const std::string& name, const Like& is_like) {
    const std::unique_ptr<octomap::AbstractOcTree> tree(
        octomap::AbstractOcTree::read((file(name) / "map_color.ot").string()));
    const auto* map = dynamic_cast<const octomap::ColorOcTree*>(tree.get());
    EXPECT_NE(map, nullptr);
    std::size_t count = 0;
    for (auto it = map->begin_leafs(); it != map->end_leafs(); ++it) {
      if (map->isNodeOccupied(*it) && is_like(it->getColor())) ++count;
    }
    return count;
  }
  static std::set<volume::VoxelKey> occupied(const fs::path& tree) {
    std::set<volume::VoxelKey> keys;
    volume::for_each_voxel(volume::VolumeMap::from_file(test::bytes_of(tree), tree.string()),
                           [&](const volume::VoxelKey& key) { keys.insert(key); });
    return keys;
  }
  static fs::path file(const std::string& name) { return folder_->path() / name; }

  static void expect_gone(const nlohmann::json& summary) {
    EXPECT_GT(summary["truth"]["moving_made"], 50) << summary["truth"];
    EXPECT_GE(summary["truth"]["gone"], 0.95) << summary["truth"];
    EXPECT_LE(summary["truth"]["lost"], 0.01) << summary["truth"];
  }

 private:
  inline static std::unique_ptr<test::TemporaryDirectory> folder_;
};

TEST_F(VolumePeople, AreGoneWithPosesOfTheSameSlamThatLabelsBeamsFromTheColoursToo) {
  const nlohmann::json summary = volume("slam", "--remember --set has_textures=true");
  EXPECT_EQ(summary["poses"], "slam");
  EXPECT_EQ(summary["moving"], "boxes");
  expect_gone(summary);
  // The crate that is put down at half time, at (10.4, 2.2). The map's frame begins where the robot
  // does.
  const Pose2 world_from_map = log::read_trajectory(file("sim") / "truth.tum").front().pose;
  const Eigen::Vector2d crate_m = inverse(world_from_map) * Eigen::Vector2d(10.4, 2.2);
  bool is_crate_told = false;
  const nlohmann::json changes = json_of(file("slam") / "changes.json");
  for (const auto& change : changes) {
    const auto box = change["box_m"].get<std::vector<double>>();
    ASSERT_EQ(box.size(), 6U);
    const bool is_there = std::abs(0.5 * (box[0] + box[3]) - crate_m.x()) < 0.3 &&
                          std::abs(0.5 * (box[1] + box[4]) - crate_m.y()) < 0.3;
    is_crate_told = is_crate_told || (is_there && change["kind"] == "appeared");
  }
  EXPECT_TRUE(is_crate_told) << changes;
  EXPECT_GE(summary["memory"]["bytes_per_voxel"], 7.0);
  // What appeared is green in the picture, and nothing is red for gone.
  const report::Image picture = test::decode(test::bytes_of(file("slam") / "changes.png"));
  int green = 0;
  int red = 0;
  for (int i = 0; i < picture.width() * picture.height(); ++i) {
    const report::Color c = picture.at(i % picture.width(), i / picture.width());
    green += c.g > c.r + 60 ? 1 : 0;
    red += c.r > c.g + 60 ? 1 : 0;
  }
  EXPECT_GT(green, 100);
  EXPECT_EQ(red, 0);
  // People are magenta, furniture is brown.
  EXPECT_GT(summary["colors"]["images"], 30);
  const std::size_t colored_voxels = summary["colors"]["colored"];
  EXPECT_GT(colored_voxels, 3000U);
  using Color = octomap::ColorOcTreeNode::Color;
  const auto magenta = colored("slam", [](const Color& c) { return c.r > c.g + 100; });
  const auto brown = colored("slam", [](const Color& c) { return c.r > c.b + 40; });
  EXPECT_LE(magenta, colored_voxels / 1000);
  EXPECT_GT(brown, 300U);
  EXPECT_EQ(test::bytes_of(file("slam") / "textured.glb").substr(0, 4), "glTF");
  EXPECT_TRUE(fs::exists(file("slam") / "textured_above.png"));
  EXPECT_GT(summary["textures"]["polygons"], 10);
  EXPECT_LE(summary["textures"]["seen"], summary["textures"]["texels"]);
  EXPECT_GT(summary["textures"]["seen"], 100'000);
}

TEST_F(VolumePeople, AreGoneWithoutAPlanarScanner) {
  const nlohmann::json summary = volume(
      "voxels", "--moving voxels --set has_textures=true --set textures.max_edge=64 --poses " +
                    quoted(file("sim") / "truth.tum"));
  EXPECT_EQ(summary["moving"], "voxels");
  expect_gone(summary);
  // More surface than fits into so small a texture takes nothing else away.
  EXPECT_FALSE(summary.contains("textures"));
  EXPECT_FALSE(fs::exists(file("voxels") / "textured.glb"));
  EXPECT_TRUE(fs::exists(file("voxels") / "map_color.ot"));
}

TEST_F(VolumePeople, AreGoneWithGivenPosesInTheirFrame) {
  const nlohmann::json summary =
      volume("given", "--slice 0.2:0.5 --poses " + quoted(file("sim") / "truth.tum"));
  EXPECT_EQ(summary["poses"], "poses");
  EXPECT_EQ(summary["moving"], "boxes and voxels");
  expect_gone(summary);
  // The walls are where the scenario has them: x = 14 to the right of the second room.
  const ReflectionGrid slice = log::read_map(file("given") / "slice_1.yaml");
  EXPECT_EQ(slice.get({140, 50}), 1.0F);
  EXPECT_EQ(slice.get({60, 45}), 0.0F);

  // The localizer works in the slice as in any map.
  pipeline::RunsInput input;
  input.logs = {file("sim") / "log.clf"};
  input.truths = {file("sim") / "truth.tum"};
  const pipeline::Runs runs = pipeline::read_runs(input, nullptr);
  maps::Maps maps;
  maps.given = slice;
  const maps::MapModel model = maps::make_map_model(maps, "map", {});
  localization::LocalizerConfig config;
  config.particles = 500;
  const Eigen::Vector3d variance(0.04, 0.04, 0.01);
  const auto run = pipeline::localize(
      std::span(runs.observations).first(150), std::span(runs.truths).first(150), model, slice,
      config, {Pose2Gaussian{*runs.truths.front(), variance.asDiagonal()}}, 1, 1, nullptr);
  const pipeline::LocalizationMetrics metrics = pipeline::evaluate_run(run.errors);
  EXPECT_EQ(run.errors.size(), 150U);
  EXPECT_LT(metrics.error_m.median, 0.1);
  EXPECT_LT(metrics.error_m.max, 0.5);
}

TEST_F(VolumePeople, MapOfTheComponentInAReplayAgreesWithTheVerbs) {
  const auto replay = [](const std::string& name, const std::string& options) {
    const auto outcome = run_strata("replay " + quoted(file("sim") / "bag") +
                                    " --composition '" STRATA_SOURCE_DIR
                                    "/components/config/volume.yaml' --quiet --out " +
                                    quoted(file(name)) + " " + options + " 2>&1");
    ASSERT_EQ(outcome.code, 0) << outcome.out;
  };
  replay("one", "--threads 1");
  replay("two", "--threads 2");
  EXPECT_TRUE(test::bytes_of(file("one") / "volume/map.ot") ==
              test::bytes_of(file("two") / "volume/map.ot"));
  (void)volume("offline", "--moving boxes");
  // Labels and poses are those of the moment: alike, not the same.
  const std::set<volume::VoxelKey> ours = occupied(file("one") / "volume/map.bt");
  const std::set<volume::VoxelKey> offline = occupied(file("offline") / "map.bt");
  std::vector<volume::VoxelKey> both;
  std::set_intersection(ours.begin(), ours.end(), offline.begin(), offline.end(),
                        std::back_inserter(both));
  EXPECT_GT(offline.size(), 40000U);
  EXPECT_GT(both.size(), 0.95 * static_cast<double>(offline.size()));
  EXPECT_GT(both.size(), 0.95 * static_cast<double>(ours.size()));
}

TEST_F(VolumePeople, AreNotGoneWithoutFilter) {
  const nlohmann::json summary = volume("raw", "--moving none");
  EXPECT_EQ(summary["moving"], "nothing");
  EXPECT_EQ(summary["truth"]["gone"], 0.0);
}

TEST_F(VolumePeople, CloudsOutsideTheGivenPosesAreLeftOutAndCounted) {
  // Poses of the first 20 s only.
  std::ifstream in(file("sim") / "truth.tum");
  std::ofstream out(file("half.tum"));
  std::string line;
  for (int i = 0; i < 200 && std::getline(in, line); ++i) out << line << '\n';
  out.close();
  const nlohmann::json summary =
      volume("half", "--moving none --poses " + quoted(file("half.tum")));
  EXPECT_EQ(summary["clouds"], 20);
  EXPECT_GT(summary["skipped"]["clouds_without_pose"], 15);
  EXPECT_THAT(summary["skipped"]["first_bad"].get<std::string>(),
              testing::HasSubstr("nothing connects scanner3 to map"));
}

}  // namespace
}  // namespace strata::tools
