// SPDX-License-Identifier: Apache-2.0
/// Names, types and QoS of the topics that others rely on, as `run --check` tells them.
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "components/maps/maps_folder.hpp"
#include "components/site/site.hpp"
#include "tests/components/maps/learned_room.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/replay_fixture.hpp"

namespace strata::tools {
namespace {

/// "writes /map" and "nav_msgs/msg/OccupancyGrid  [reliable, latched, last 1]" for each topic that
/// the sample compositions read or write, with what is off unless asked for.
std::map<std::string, std::string> explained_topics() {
  const test::TemporaryDirectory folder;
  const slam::SlamResult slam = maps::test_room::make_slam_result();
  maps::write_grid_maps(folder.path(), slam);
  maps::write_patch_map(folder.path(), maps::test_room::make_patch_map(slam));
  const site::Actor somebody{"ada", 1};
  const test::TemporaryDirectory beside;
  site::Site site = site::Site::create(beside.path() / "site", "hall", "map", somebody);
  std::ofstream(folder.path() / maps::kSummaryFile) << R"({"kind": "maps"})";
  const std::string hash = site.add(folder.path(), somebody, "").status.version.hash;
  site.approve(hash, somebody, "");
  (void)site.activate(hash, somebody);
  const std::map<std::string, std::string> asked_of = {
      {"learn_and_localize", " --set localizer.change_mask.kind=penalty"},
      {"localize", " --set localizer.maps=" + test::quoted(site.folder())}};
  std::map<std::string, std::string> topics;
  for (const std::string name :
       {"learn_and_localize", "localize", "mapping", "topology", "volume"}) {
    const auto found = asked_of.find(name);
    const std::string asked = found == asked_of.end() ? "" : found->second;
    const test::Outcome explained = test::run_strata(
        "run --check " +
        test::quoted(std::string(STRATA_SOURCE_DIR) + "/components/config/" + name + ".yaml") +
        asked);
    EXPECT_EQ(explained.code, 0) << name;
    std::istringstream lines(explained.out);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string verb;
      std::string topic;
      std::string type;
      if (!(words >> verb >> topic >> type) || (verb != "reads" && verb != "writes")) continue;
      const std::size_t begin = line.find('[');
      const std::string qos = line.substr(begin, line.find(']') + 1 - begin);
      const auto [known, is_new] = topics.try_emplace(verb + " " + topic, type + "  " + qos);
      EXPECT_TRUE(is_new || known->second == type + "  " + qos || verb == "reads") << line;
    }
  }
  return topics;
}

TEST(ContractTopics, HaveTheTypesAndTheQosThatOthersRelyOn) {
  const std::string sensor_data = "  [best effort, last 5]";
  const std::string reliable = "  [reliable, last 10]";
  const std::string latched = "  [reliable, latched, last 1]";
  const std::string scan = "sensor_msgs/msg/LaserScan";
  const std::string map = "nav_msgs/msg/OccupancyGrid";
  const std::string pose = "geometry_msgs/msg/PoseWithCovarianceStamped";
  const std::map<std::string, std::string> contract = {
      {"reads /scan", scan + sensor_data},
      {"reads /odom", "nav_msgs/msg/Odometry" + sensor_data},
      {"reads /tf", "tf2_msgs/msg/TFMessage  [reliable, last 100]"},
      {"reads /tf_static", "tf2_msgs/msg/TFMessage  [reliable, latched, last 100]"},
      {"reads /initialpose", pose + reliable},
      {"writes /tf", "tf2_msgs/msg/TFMessage  [reliable, last 100]"},
      {"writes /map", map + latched},
      {"writes /map_filtered", map + latched},
      {"writes /map_current", map + latched},
      {"writes /change_mask", map + latched},
      {"writes /change_mask_info", "nav2_msgs/msg/CostmapFilterInfo" + latched},
      {"writes /zones/keepout", map + latched},
      {"writes /zones/keepout_info", "nav2_msgs/msg/CostmapFilterInfo" + latched},
      {"writes /zones/preferred", map + latched},
      {"writes /zones/speed", map + latched},
      {"writes /zones/speed_m_s", map + latched},
      {"writes /zones/never_learn", map + latched},
      {"writes /zones/static_only_info", "nav2_msgs/msg/CostmapFilterInfo" + latched},
      {"writes /amcl_pose", pose + latched},
      {"writes /particle_cloud", "nav2_msgs/msg/ParticleCloud" + sensor_data},
      {"writes /scan_static", scan + sensor_data},
      {"writes /scan_dynamic", scan + sensor_data},
      {"writes /expected_scan/short", scan + reliable},
      {"writes /expected_scan/mid", scan + reliable},
      {"writes /expected_scan/long", scan + reliable},
      {"writes /patch_map", "strata_msgs/msg/PatchMap" + latched},
      {"writes /localizer/patch_map", "strata_msgs/msg/PatchMap" + latched},
      {"writes /submap_states", "strata_msgs/msg/SubmapStates" + latched},
      {"writes /node_map", "strata_msgs/msg/NodeMap" + latched},
      {"writes /topologies", "strata_msgs/msg/Topologies" + latched},
      {"writes /localization_health", "strata_msgs/msg/LocalizationHealth" + latched},
      {"writes /localization_score", "std_msgs/msg/Float64" + reliable},
      {"writes /octomap_binary", "octomap_msgs/msg/Octomap" + latched},
      {"writes /octomap_color", "octomap_msgs/msg/Octomap" + latched},
  };
  const std::map<std::string, std::string> topics = explained_topics();
  for (const auto& [topic, promised] : contract) {
    const auto found = topics.find(topic);
    ASSERT_NE(found, topics.end()) << topic;
    EXPECT_EQ(found->second, promised) << topic;
  }
}

}  // namespace
}  // namespace strata::tools
