// SPDX-License-Identifier: Apache-2.0
/// `strata volume` as users meet it, beside OctoMap's own tools.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "components/log/map_file.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/program.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using test::bytes_of;
using test::quoted;
using test::run_strata;

bool shell(const std::string& command) { return std::system(command.c_str()) == 0; }

/// Our files and those that OctoMap's tools make of the same log, byte by byte.
void expect_same_trees(const fs::path& log, bool is_graph, const std::string& resolution) {
  const test::TemporaryDirectory folder;
  const fs::path graph = folder.path() / "a.graph";
  const fs::path plain = folder.path() / "a.log";
  const fs::path theirs = folder.path() / "theirs.bt";
  ASSERT_TRUE(shell("zcat -f " + quoted(log) + " > " + quoted(is_graph ? graph : plain)));
  if (!is_graph) {
    ASSERT_TRUE(shell("log2graph " + quoted(plain) + " " + quoted(graph) + " >/dev/null 2>&1"));
  }
  ASSERT_TRUE(shell("graph2tree -i " + quoted(graph) + " -o " + quoted(theirs) + " -res " +
                    resolution + " >/dev/null 2>&1"));
  const fs::path out = folder.path() / "ours";
  ASSERT_EQ(run_strata("volume " + quoted(log) + " --no-filter --quiet --resolution " + resolution +
                       " --out " + quoted(out))
                .code,
            0);
  const std::string binary = bytes_of(out / "map.bt");
  ASSERT_GT(binary.size(), 1000U);
  EXPECT_TRUE(binary == bytes_of(theirs));
  EXPECT_TRUE(bytes_of(out / "map.ot") == bytes_of(theirs.string() + ".ot"));
}

TEST(Volume, MakesTheTreesOfOctomapsTools) {
  if (!shell("command -v graph2tree log2graph >/dev/null")) GTEST_SKIP() << "no octomap-tools";
  STRATA_REQUIRE_DATA(hallway, "hallway_3d/hallway.log.gz");
  STRATA_REQUIRE_DATA(scan, "octomap_3d/scan_node.log.gz");
  STRATA_REQUIRE_DATA(sphere, "octomap_3d/spherical_scan.graph");
  expect_same_trees(hallway, false, "0.1");
  expect_same_trees(scan, false, "0.1");
  expect_same_trees(sphere, true, "0.05");
}

TEST(Volume, PicturesATreeOfOctomapAndWritesItAsItWas) {
  STRATA_REQUIRE_DATA(tree, "octomap_3d/geb079.bt");
  const test::TemporaryDirectory folder;
  const fs::path out = folder.path() / "out";
  ASSERT_EQ(run_strata("volume " + quoted(tree) + " --quiet --out " + quoted(out)).code, 0);
  EXPECT_TRUE(bytes_of(out / "map.bt") == bytes_of(tree));
  EXPECT_EQ(nlohmann::json::parse(bytes_of(out / "summary.json"))["nodes"], 532566);
  EXPECT_TRUE(fs::exists(out / "outside_1.png"));
}

TEST(Volume, SaysAtOnceThatABagHoldsNoClouds) {
  STRATA_REQUIRE_DATA(bag, "olin_mac/take_2_db3");
  const test::TemporaryDirectory folder;
  const auto outcome =
      run_strata("volume " + quoted(bag) + " --out " + quoted(folder.path() / "out") + " 2>&1");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.out, ::testing::StartsWith("strata volume: error: " + bag.string() +
                                                 ": holds no point clouds"));
  EXPECT_THAT(outcome.out, ::testing::Not(::testing::HasSubstr("match scans")));
}

/// Points on two walls, 2 m ahead and 2 m to the left.
void write_corner(const fs::path& path) {
  std::ofstream out(path);
  for (int cloud = 0; cloud < 3; ++cloud) {
    out << "NODE 0.05 0.05 1.05 0 0 0\n";
    for (int i = -10; i <= 10; ++i) {
      for (int z = -5; z <= 5; ++z) {
        out << "2 " << 0.1 * i << ' ' << 0.1 * z << '\n' << 0.1 * i << " 2 " << 0.1 * z << '\n';
      }
    }
  }
}

TEST(Volume, WritesMapsSlicesPicturesAndASummary) {
  const test::TemporaryDirectory folder;
  write_corner(folder.path() / "corner.log");
  const fs::path out = folder.path() / "out";
  const auto outcome = run_strata("volume " + quoted(folder.path() / "corner.log") + " --out " +
                                  quoted(out) + " --slice 0.9:1.2 --slice 5:6 2>/dev/null");
  ASSERT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, testing::HasSubstr("3 clouds"));
  for (const char* file : {"map.bt", "map.ot", "slice_1.yaml", "slice_1.pgm", "slice_2.yaml",
                           "above.png", "outside_1.png", "inside.png", "report.html"}) {
    EXPECT_TRUE(fs::exists(out / file)) << file;
  }
  const auto summary = nlohmann::json::parse(bytes_of(out / "summary.json"));
  EXPECT_EQ(summary["clouds"], 3);
  EXPECT_EQ(summary["points"]["dynamic"], 0);
  EXPECT_EQ(summary["slices"][0]["from_m"], 0.9);
  const ReflectionGrid slice = log::read_map(out / "slice_1.yaml");
  EXPECT_EQ(slice.get({20, 0}), 1.0F);
  EXPECT_EQ(slice.get({0, 20}), 1.0F);
  EXPECT_EQ(slice.get({10, 0}), 0.0F);
  EXPECT_FALSE(is_known(slice.get({30, 0})));
}

TEST(Volume, SaysThatThereIsNothingToTextureWith) {
  const test::TemporaryDirectory folder;
  write_corner(folder.path() / "corner.log");
  const fs::path out = folder.path() / "out";
  const auto outcome = run_strata("volume " + quoted(folder.path() / "corner.log") +
                                  " --set has_textures=true --out " + quoted(out) + " 2>&1");
  EXPECT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_THAT(outcome.out, ::testing::HasSubstr("warning: has_textures: the log has no pictures"));
  EXPECT_FALSE(fs::exists(out / "textured.glb"));
}

TEST(Volume, SaysWhatIsWrongWithItsInput) {
  const test::TemporaryDirectory folder;
  write_corner(folder.path() / "corner.log");
  const std::string log = quoted(folder.path() / "corner.log");
  const std::string out = " --out " + quoted(folder.path() / "out");
  EXPECT_EQ(run_strata("volume " + log + out + " --slice 2:1 2>/dev/null").code, 2);
  EXPECT_EQ(run_strata("volume " + log + out + " --resolution 0 2>/dev/null").code, 2);
  EXPECT_EQ(run_strata("volume /nowhere" + out + " 2>/dev/null").code, 2);
  std::ofstream(folder.path() / "poseless.log") << "NODE 1 2\n1 2 3\n";
  const auto outcome =
      run_strata("volume " + quoted(folder.path() / "poseless.log") + out + " 2>&1");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.out, testing::HasSubstr("NODE without a pose"));
  EXPECT_FALSE(fs::exists(folder.path() / "out"));
}

}  // namespace
}  // namespace strata::tools
