// SPDX-License-Identifier: Apache-2.0
/// A robot's process is killed on its host, while its sensors live on another: every component goes
/// on from what it kept.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "strata_idl/geometry_msgs.h"
#include "strata_idl/strata_msgs.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/log/bag.hpp"
#include "components/log/state_store.hpp"
#include "core/base/error.hpp"
#include "core/beam_filter/online_filter.hpp"
#include "core/slam/slam.hpp"
#include "memory/store/store.hpp"
#include "tests/network/killed_robot.hpp"
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

/// What was recorded of one type. Empty as long as there is no bag to read.
template <typename Message>
std::vector<Message> messages_in(const fs::path& bag, std::string_view type) {
  std::vector<Message> messages;
  try {
    const auto reader = log::BagReader::open(bag);
    log::BagMessage message;
    while (reader->next(message)) {
      if (reader->topics()[message.topic].type != type) continue;
      messages.push_back(convert::from_cdr<Message>(message.data, "recorded"));
    }
  } catch (const InputError&) {  // only just begun
  }
  return messages;
}

template <typename Message = geometry_msgs::msg::PoseWithCovarianceStamped>
std::vector<Located> poses_in(const fs::path& bag) {
  std::vector<Located> poses;
  for (const Message& message : messages_in<Message>(bag, convert::message_type<Message>())) {
    poses.push_back(located(message));
  }
  return poses;
}

/// When the robot was at the landmarks that the messages tell of.
std::vector<std::vector<Stamp>> visits_in(const fs::path& bag) {
  using strata_msgs::msg::Topologies;
  std::vector<std::vector<Stamp>> visits;
  for (const auto& message : messages_in<Topologies>(bag, convert::message_type<Topologies>())) {
    visits.emplace_back();
    for (const auto& stamp : message.visits()) {
      visits.back().push_back(convert::from_message(stamp));
    }
  }
  return visits;
}

std::size_t kept_scans_in(const fs::path& state) {
  if (!fs::exists(state)) return 0;
  slam::Slam slam{slam::SlamConfig{}};
  slam.restore_state(log::read_state_file(state), state.string());
  return slam.kept_scans();
}

std::size_t filtered_scans_in(const fs::path& state) {
  if (!fs::exists(state)) return 0;
  beam_filter::OnlineFilter filter;
  filter.restore_state(log::read_state_file(state), state.string());
  return filter.scans_in_window();
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

/// What a store holds of something that only grows.
class Growing {
 public:
  explicit Growing(std::function<std::size_t()> count) : count_(std::move(count)) {}
  void look() { max_ = std::max(max_, count_()); }
  [[nodiscard]] bool comes_to(std::size_t enough) const {
    return comes_true([&] { return count_() >= enough; });
  }
  /// Whether more is added to what there was, and nothing begins anew. After a look.
  [[nodiscard]] bool grows_on() {
    const std::size_t seen = max_;
    std::size_t least = count_();
    look();  // what was written between the first look and the kill
    const bool grew = comes_true([&] {
      const std::size_t now = count_();
      least = std::min(least, now);
      return now > max_;
    });
    return grew && least >= seen;
  }

 private:
  std::function<std::size_t()> count_;
  std::size_t max_ = 0;
};

class RobotThatIsKilled : public KilledRobot {
 protected:
  void SetUp() override {
    KilledRobot::SetUp();
    if (IsSkipped()) return;
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
        << "}\n      - type: strata::BeamFilter\n        name: filter\n"
           "        parameters:\n          window: {scans: 100000}\n          store: {period_s: "
           "0.5, file: "
        << at("filter.state").string()
        << "}\n      - type: strata::TopologyMapper\n        name: topology\n"
           "        parameters:\n          landmark_times_s: [0.5]\n"
           "          mapping: {landmarks: {source: given, patch: {path_radius_m: 0.5}}}\n"
           "          store: {save_period_s: 0.1, file: "
        << at("way.db").string()
        << "}\n      - type: strata::Recorder\n        name: recorder\n        parameters:\n"
           "          out: "
        << at("bag").string()
        << "\n          number_if_exists: true\n"
           "          topics: ['/scan_pose:strata_msgs/msg/ScanPose', "
           "'/topologies:strata_msgs/msg/Topologies']\n";
  }
  [[nodiscard]] fs::path log() const { return at("sim") / "day_1" / "log.clf"; }
};

TEST_F(RobotThatIsKilled, GoesOnFromItsStoresWithEveryComponent) {
  if (IsSkipped()) return;
  constexpr std::size_t kEnough = 10;
  const auto sensors = run(1, "sensors.yaml");
  const auto robot = run(0, "robot.yaml");
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
  const auto sensors = run(1, "sensors.yaml");
  const auto robot = run(0, "mapping.yaml");
  const auto poses = [&](const char* bag) { return poses_in<strata_msgs::msg::ScanPose>(at(bag)); };
  constexpr std::size_t kEnough = 10;
  Growing map([&] { return kept_scans_in(at("slam.state")); });
  Growing filter([&] { return filtered_scans_in(at("filter.state")); });
  Growing way([&] { return way_in(at("way.db")); });
  ASSERT_TRUE(comes_true([&] { return poses("bag").size() >= kEnough; }));
  for (Growing* kept : {&map, &filter, &way}) ASSERT_TRUE(kept->comes_to(kEnough));
  ASSERT_TRUE(comes_true([&] { return !visits_in(at("bag")).empty(); }));
  for (Growing* kept : {&map, &filter, &way}) kept->look();
  kill_and_wait(*robot);
  EXPECT_TRUE(map.grows_on()) << "a map was begun anew";
  EXPECT_TRUE(filter.grows_on()) << "a filter was begun anew";
  EXPECT_TRUE(way.grows_on()) << "a way was begun anew";
  ASSERT_TRUE(comes_true([&] { return poses("bag_2").size() >= kEnough; }));
  const Located before = poses("bag").back();
  const Located after = poses("bag_2").front();
  EXPECT_LT(translation_distance(before.map_from_robot, after.map_from_robot),
            0.1 + 0.25 * (after.stamp - before.stamp).seconds());
  ASSERT_TRUE(comes_true([&] { return !visits_in(at("bag_2")).empty(); }));
  EXPECT_EQ(visits_in(at("bag_2")).front(), visits_in(at("bag")).back())
      << "topologies were begun anew";
}

}  // namespace
}  // namespace strata::test
