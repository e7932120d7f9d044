// SPDX-License-Identifier: Apache-2.0
#include "components/clouds/cloud_reader.hpp"

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>
#include <octomap/ScanGraph.h>

#include "core/base/error.hpp"
#include "core/volume/volume_map.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::clouds {
namespace {

constexpr const char* kTwoClouds =
    "NODE 1.5 0.25 -0.1 0.1 -0.2 2.5\n1 2 3\n0.5 -0.25 0.125\n\n"
    "NODE 0 1 2 0 0 -1\n# comment\n3 2 1\n";

fs::path write(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

std::vector<volume::Cloud> read_all(CloudReader& reader) {
  std::vector<volume::Cloud> clouds;
  for (volume::Cloud cloud; reader.next(cloud);) clouds.push_back(cloud);
  return clouds;
}

/// The scan graph as OctoMap itself writes it.
std::string graph_bytes(const std::string& text) {
  octomap::ScanGraph graph;
  std::istringstream in(text);
  graph.readPlainASCII(in);
  std::ostringstream out;
  graph.writeBinary(out);
  return out.str();
}

TEST(CloudReader, ReadsOctomapsTextLogWithItsPoses) {
  const test::TemporaryDirectory folder;
  const auto reader = CloudReader::open(write(folder.path() / "a.log", kTwoClouds));
  const auto clouds = read_all(*reader);
  ASSERT_EQ(clouds.size(), 2U);
  EXPECT_EQ(clouds[0].points_m.size(), 2U);
  EXPECT_EQ(clouds[1].points_m[0], Eigen::Vector3f(3, 2, 1));
  EXPECT_LT(clouds[0].stamp, clouds[1].stamp);
  const octomap::pose6d pose(1.5F, 0.25F, -0.1F, 0.1F, -0.2F, 2.5F);
  EXPECT_EQ(clouds[0].map_from_sensor.rotation.w(), static_cast<double>(pose.rot().u()));
  EXPECT_EQ(clouds[0].map_from_sensor.rotation.z(), static_cast<double>(pose.rot().z()));
  EXPECT_EQ(reader->report().bad_lines, 0U);
}

TEST(CloudReader, ReadsTheSameCloudsFromAScanGraph) {
  const test::TemporaryDirectory folder;
  const auto text = read_all(*CloudReader::open(write(folder.path() / "a.log", kTwoClouds)));
  const auto graph =
      read_all(*CloudReader::open(write(folder.path() / "a.graph", graph_bytes(kTwoClouds))));
  ASSERT_EQ(graph.size(), text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    EXPECT_EQ(graph[i].points_m, text[i].points_m);
    EXPECT_EQ(graph[i].map_from_sensor.translation, text[i].map_from_sensor.translation);
    EXPECT_EQ(graph[i].map_from_sensor.rotation.coeffs(),
              text[i].map_from_sensor.rotation.coeffs());
  }
}

TEST(CloudReader, LeavesOutACloudWhosePoseIsMissingAndReadsTheRest) {
  const test::TemporaryDirectory folder;
  const auto reader = CloudReader::open(
      write(folder.path() / "a.log",
            "NODE 0 0 0 0 0 0\n1 1 1\nNODE 1 2 3\n2 2 2\n2 2 3\nNODE 0 0 1 0 0 0\n3 3 3\nx y\n"));
  const auto clouds = read_all(*reader);
  ASSERT_EQ(clouds.size(), 2U);
  EXPECT_EQ(clouds[0].points_m.size(), 1U);
  EXPECT_EQ(clouds[1].points_m.size(), 1U);
  EXPECT_EQ(reader->report().clouds_without_pose, 1U);
  EXPECT_EQ(reader->report().points_without_pose, 2U);
  EXPECT_EQ(reader->report().bad_lines, 2U);
  EXPECT_THAT(reader->report().first_bad, testing::HasSubstr("a.log:3: NODE without a pose"));
}

TEST(CloudReader, ReadsACutScanGraphUpToTheCut) {
  const test::TemporaryDirectory folder;
  const std::string whole = graph_bytes(kTwoClouds);
  for (std::size_t size = 12; size < whole.size() - 4; ++size) {
    const auto reader = CloudReader::open(write(folder.path() / "a.graph", whole.substr(0, size)));
    const auto clouds = read_all(*reader);
    ASSERT_LE(clouds.size(), 2U);
    if (clouds.size() < 2) {
      ASSERT_EQ(reader->report().bad_lines, 1U) << size;
      ASSERT_THAT(reader->report().first_bad, testing::HasSubstr("is cut"));
    }
  }
}

TEST(CloudReader, RefusesWhatIsNoCloudLog) {
  const test::TemporaryDirectory folder;
  EXPECT_THROW((void)CloudReader::open(folder.path() / "none"), InputError);
  EXPECT_THROW((void)CloudReader::open(write(folder.path() / "a", "FLASER 1 2\n")), InputError);
  EXPECT_THROW((void)CloudReader::open(write(folder.path() / "b", "")), InputError);
}

/// The tree that OctoMap's own reader and insertion make of a log, as graph2tree does.
octomap::OcTree octomaps_tree(const fs::path& plain, double resolution_m) {
  octomap::ScanGraph graph;
  graph.readPlainASCII(plain.string());
  octomap::OcTree tree(resolution_m);
  for (const octomap::ScanNode* node : graph) tree.insertPointCloud(*node);
  return tree;
}

TEST(CloudReader, GivesTheTreeOfOctomapOnARealHallway) {
  STRATA_REQUIRE_DATA(packed, "hallway_3d/hallway.log.gz");
  const test::TemporaryDirectory folder;
  const fs::path plain = folder.path() / "hallway.log";
  ASSERT_EQ(std::system(("gzip -dc '" + packed.string() + "' > '" + plain.string() + "'").c_str()),
            0);
  octomap::OcTree tree = octomaps_tree(plain, 0.1);
  volume::VolumeMap map(volume::VolumeConfig{});
  WorkerPool pool(2);
  const auto reader = CloudReader::open(packed);
  for (volume::Cloud cloud; reader->next(cloud);) map.insert(cloud, {}, pool);
  EXPECT_EQ(reader->report().clouds, 3U);
  EXPECT_GT(map.size().nodes, 10000U);
  EXPECT_EQ(map.size().nodes, tree.size());
  std::ostringstream bytes;
  tree.write(bytes);
  EXPECT_EQ(map.full_file(), bytes.str());
}

}  // namespace
}  // namespace strata::clouds
