// SPDX-License-Identifier: Apache-2.0
/// A robot's process is killed on its host, while its sensors live on another: every component goes
/// on from what it kept.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "strata_idl/geometry_msgs.h"
#include "strata_idl/strata_msgs.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/log/bag.hpp"
#include "components/log/state_store.hpp"
#include "core/base/error.hpp"
#include "core/slam/slam.hpp"
#include "memory/store/store.hpp"
#include "tests/network/virtual_network.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/program.hpp"

namespace fs = std::filesystem;

namespace strata::test {
namespace {

/// Of a localizer, as it was recorded.
struct Located {
  Stamp stamp;
  Pose2 map_from_robot;
};

Located located(const geometry_msgs::msg::PoseWithCovarianceStamped& message) {
  return {convert::from_message(message.header().stamp()),
          planar(convert::from_message(message.pose().pose()))};
}
Located located(const strata_msgs::msg::ScanPose& message) {
  return {convert::from_message(message.header().stamp()),
          convert::from_message(message.map_from_robot().mean())};
}

/// Empty as long as there is no bag to read.
template <typename Message = geometry_msgs::msg::PoseWithCovarianceStamped>
std::vector<Located> poses_in(const fs::path& bag) {
  std::vector<Located> poses;
  try {
    const auto reader = log::BagReader::open(bag);
    log::BagMessage message;
    while (reader->next(message)) {
      poses.push_back(located(convert::from_cdr<Message>(message.data, "recorded pose")));
    }
  } catch (const InputError&) {  // only just begun
  }
  return poses;
}

std::size_t kept_scans_in(const fs::path& state) {
  if (!fs::exists(state)) return 0;
  slam::Slam slam{slam::SlamConfig{}};
  slam.restore_state(log::read_state_file(state), state.string());
  return slam.kept_scans();
}

std::size_t way_in(const fs::path& store) {
  if (!fs::exists(store)) return 0;
  return memory::Store(store, {.read_only = true, .check = false}).load_scans(0).size();
}

std::uint64_t observations_in(const fs::path& store) {
  if (!fs::exists(store)) return 0;
  const memory::Store reader(store, {.read_only = true, .check = false});
  return reader.has_timescale() ? reader.load_timescale().observations() : 0;
}

/// How many scans the patch learner had seen when it began, this life or the one before; -1: none.
long scans_at_start(const fs::path& learned) {
  long most = -1;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(learned, error)) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() == ".db") most = std::max(most, std::stol(name.substr(6)));
  }
  return most;
}

bool comes_true(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
  }
  return true;
}

class RobotThatIsKilled : public testing::Test {
 protected:
  void SetUp() override {
    try {
      network_ = std::make_unique<VirtualNetwork>(2);
    } catch (const OutputError& error) {
      GTEST_SKIP() << error.what();
    }
    // Slow, so that three lives of the robot's process fit into one drive.
    ASSERT_EQ(run_strata("simulate --quiet '" STRATA_SCENARIO_DIR
                         "/empty_room.yaml' --per-day --set robot.speed_mps=0.2 --out " +
                         quoted(at("sim")))
                  .code,
              0);
    ASSERT_EQ(run_strata("learn --quiet " + quoted(log()) + " --poses " +
                         quoted(at("sim") / "day_1" / "truth.tum") + " --out " + quoted(at("maps")))
                  .code,
              0);
    std::ofstream(at("sensors.yaml"))
        << "version: 1\nprocesses:\n  - name: sensors\n    components:\n"
           "      - {type: strata::Player, name: player, parameters: {log: "
        << log().string() << "}}\n";
    std::ofstream(at("robot.yaml"))
        << "version: 1\nprocesses:\n  - name: robot\n    restart: on_failure\n"
           "    restart_delay_s: 0\n    components:\n"
           "      - type: strata::Localizer\n        name: localizer\n        parameters:\n"
           "          maps: "
        << at("maps").string()
        << "\n          model: filtered\n          located_topic: located_scan\n"
           "          start: {pose: [1, 1, 0], store: {period_s: 0, file: "
        << at("place.yaml").string()
        << "}}\n"
           "      - type: strata::TimescaleMemory\n        name: memory\n        parameters: "
           "{store: "
        << at("memory.db").string()
        << ", save_period_s: 0.2}\n        remappings: {labeled_scan: located_scan}\n"
           "      - type: strata::PatchLearner\n        name: patch_learner\n        parameters:\n"
           "          online: {enabled: true, scan_topic: located_scan, maps: "
        << at("maps").string() << ", store: {save_period_s: 0.1, folder: " << at("learned").string()
        << "}}\n"
           "      - type: strata::Recorder\n        name: recorder\n        parameters:\n"
           "          out: "
        << at("bag").string()
        << "\n          number_if_exists: true\n"
           "          topics: ['/amcl_pose:geometry_msgs/msg/PoseWithCovarianceStamped']\n";
  }
  /// A robot that maps: nothing is known when it first begins.
  void write_mapping_robot() const {
    std::ofstream(at("mapping.yaml"))
        << "version: 1\nprocesses:\n  - name: robot\n    restart: on_failure\n"
           "    restart_delay_s: 0\n    components:\n"
           "      - type: strata::ScanMatcher\n        name: slam\n        parameters:\n"
           "          store: {period_s: 0.5, file: "
        << at("slam.state").string()
        << "}\n      - type: strata::TopologyMapper\n        name: topology\n"
           "        parameters: {store: {save_period_s: 0.1, file: "
        << at("way.db").string()
        << "}}\n      - type: strata::Recorder\n        name: recorder\n        parameters:\n"
           "          out: "
        << at("bag").string()
        << "\n          number_if_exists: true\n"
           "          topics: ['/scan_pose:strata_msgs/msg/ScanPose']\n";
  }
  /// Kills the robot's only process and waits for the next.
  static void kill_and_wait(const ChildProcess& robot) {
    const std::set<pid_t> processes = robot.children();
    ASSERT_EQ(processes.size(), 1U);
    kill(*processes.begin(), SIGKILL);
    ASSERT_TRUE(comes_true([&] {
      const std::set<pid_t> now = robot.children();
      return now.size() == 1 && now != processes;
    }));
  }
  [[nodiscard]] fs::path log() const { return at("sim") / "day_1" / "log.clf"; }
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }

  TemporaryDirectory folder_;
  std::unique_ptr<VirtualNetwork> network_;
};

TEST_F(RobotThatIsKilled, GoesOnFromItsStoresWithEveryComponent) {
  if (IsSkipped()) return;
  constexpr std::size_t kEnough = 10;
  const auto sensors =
      network_->run(1, {STRATA_PROGRAM, "run", "--quiet", at("sensors.yaml").string()});
  const auto robot =
      network_->run(0, {STRATA_PROGRAM, "run", "--quiet", at("robot.yaml").string()});
  std::uint64_t remembered = 0;
  long learned = -1;
  for (int life = 1; life <= 3; ++life) {
    const fs::path bag = life == 1 ? at("bag") : at("bag_" + std::to_string(life));
    ASSERT_TRUE(comes_true([&] { return poses_in(bag).size() >= kEnough; })) << "life " << life;
    ASSERT_TRUE(comes_true([&] { return observations_in(at("memory.db")) > remembered; }));
    remembered = observations_in(at("memory.db"));
    EXPECT_GT(scans_at_start(at("learned")), learned) << "life " << life;
    learned = scans_at_start(at("learned"));
    if (life > 1) {
      const Located before =
          poses_in(life == 2 ? at("bag") : at("bag_" + std::to_string(life - 1))).back();
      const Located after = poses_in(bag).front();
      const double gap_s = std::abs((after.stamp - before.stamp).seconds());
      EXPECT_LT(translation_distance(before.map_from_robot, after.map_from_robot),
                0.2 + 0.25 * gap_s)
          << "life " << life << ", " << gap_s << " s later";
    }
    kill_and_wait(*robot);
    EXPECT_GE(observations_in(at("memory.db")), remembered) << "nothing older is lost";
  }
}

TEST_F(RobotThatIsKilled, GoesOnMappingInTheMapThatItHad) {
  if (IsSkipped()) return;
  write_mapping_robot();
  const auto sensors =
      network_->run(1, {STRATA_PROGRAM, "run", "--quiet", at("sensors.yaml").string()});
  const auto robot =
      network_->run(0, {STRATA_PROGRAM, "run", "--quiet", at("mapping.yaml").string()});
  const auto poses = [&](const char* bag) { return poses_in<strata_msgs::msg::ScanPose>(at(bag)); };
  constexpr std::size_t kEnough = 10;
  ASSERT_TRUE(comes_true([&] { return poses("bag").size() >= kEnough; }));
  ASSERT_TRUE(comes_true([&] { return kept_scans_in(at("slam.state")) >= kEnough; }));
  ASSERT_TRUE(comes_true([&] { return way_in(at("way.db")) > 0; }));
  const std::size_t mapped = kept_scans_in(at("slam.state"));
  const std::size_t gone = way_in(at("way.db"));
  kill_and_wait(*robot);
  std::size_t least = mapped;
  EXPECT_TRUE(comes_true([&] {
    const std::size_t now = kept_scans_in(at("slam.state"));
    least = std::min(least, now);
    return now > mapped;
  }));
  ASSERT_TRUE(comes_true([&] { return poses("bag_2").size() >= kEnough; }));
  const Located before = poses("bag").back();
  const Located after = poses("bag_2").front();
  EXPECT_LT(translation_distance(before.map_from_robot, after.map_from_robot),
            0.1 + 0.25 * (after.stamp - before.stamp).seconds());
  EXPECT_GE(least, mapped) << "a map was begun anew";
  EXPECT_TRUE(comes_true([&] { return way_in(at("way.db")) > gone; }));
}

}  // namespace
}  // namespace strata::test
