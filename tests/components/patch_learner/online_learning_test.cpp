// SPDX-License-Identifier: Apache-2.0
/// The patch learner goes on learning over DDS while a localizer works in the maps of yesterday.
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/bus/endpoint.hpp"
#include "components/convert/patch_messages.hpp"
#include "components/localizer/register.hpp"
#include "components/log/trajectory_file.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/patch_learner/register.hpp"
#include "components/runtime/composition.hpp"
#include "components/settings/yaml_document.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/components/player/lockstep_replay.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/simulate/two_days.hpp"
#include "tools/pipeline/learn.hpp"

namespace fs = std::filesystem;

namespace strata::patch_learner {
namespace {

constexpr std::uint64_t kSeed = 7;
constexpr double kDoorsX[] = {3.05, 9.05, 15.05};

/// A hall with three doors: all closed on the day that the maps were learned on, all open on the
/// next, when the robot drives past them and back.
struct Hall {
  test::TemporaryDirectory maps;
  std::vector<Observation> observations;
  std::vector<Pose2> truth;
};

const Hall& hall() {
  static const std::unique_ptr<const Hall> made = [] {
    auto hall = std::make_unique<Hall>();
    const test::TwoDays days = test::two_days(STRATA_SCENARIO_DIR "/three_doors.yaml", 101);
    hall->observations = days.second;
    hall->truth = days.second_poses;
    const pipeline::LearnResult learned =
        pipeline::learn(days.first, days.first_poses, {}, {.patch = true}, kSeed, 1, nullptr);
    EXPECT_TRUE(learned.patches.submaps.empty()) << "one day shows one state";
    maps::write_grid_maps(hall->maps.path(), learned.slam);
    maps::write_patch_map(hall->maps.path(), learned.patches);
    return hall;
  }();
  return *made;
}

runtime::Composition composition(const std::string& zones = "") {
  const std::string maps = hall().maps.path().string();
  const Pose2& start = hall().truth.front();
  std::ostringstream text;
  text.precision(17);
  text
      << "{domain: " << test::own_domain() << ", transport: loopback, processes: [{name: main, "
      << "components: [{type: strata::Localizer, name: localizer, parameters: {maps: '" << maps
      << "', model: patch, map_topics: {follow: true}, located_topic: located_scan, start: {pose: ["
      << start.x << ", " << start.y << ", " << start.theta << "]}, "
      << "localizer: {particles: 500}}}, {type: strata::PatchLearner, name: patch_learner, "
      << "parameters: {online: {enabled: true, maps: '" << maps
      << "', scan_topic: located_scan, publish_every_s: 2}, zones: '" << zones << "'}}]}]}";
  return runtime::read_composition(settings::parse_yaml(text.str(), "test"), "test");
}

/// Every patch map that was published, and every word about health.
class Listener {
 public:
  explicit Listener(const std::shared_ptr<bus::Participant>& participant)
      : map_reader_(participant, "/patch_map", bus::qos_profile("latched").lossless(),
                    [this](const strata_msgs::msg::PatchMap& message) {
                      const std::lock_guard lock(mutex_);
                      maps_.push_back(convert::from_message(message));
                    }),
        health_reader_(participant, "/localization_health", bus::qos_profile("latched").lossless(),
                       [this](const strata_msgs::msg::LocalizationHealth& message) {
                         const std::lock_guard lock(mutex_);
                         lost_ += message.lost() ? 1 : 0;
                         ++healths_;
                         changed_.notify_all();
                       }) {}

  /// Until so many words about health have come; gives how often the robot was lost.
  std::size_t lost_of(std::size_t healths) {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(
        changed_.wait_for(lock, std::chrono::seconds(20), [&] { return healths_ >= healths; }));
    return lost_;
  }
  std::vector<patch::PatchMap> maps() {
    const std::lock_guard lock(mutex_);
    return maps_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<patch::PatchMap> maps_;
  std::size_t lost_ = 0;
  std::size_t healths_ = 0;
  bus::Reader<strata_msgs::msg::PatchMap> map_reader_;  // last: callbacks use the others
  bus::Reader<strata_msgs::msg::LocalizationHealth> health_reader_;
};

struct Outcome {
  std::size_t lost = 0;
  std::vector<patch::PatchMap> maps;  ///< published before the end
};

Outcome replay(const fs::path& out, int threads, const std::string& zones = "") {
  test::LockstepReplay replay(composition(zones),
                              {localizer::register_component, register_component}, kSeed, threads);
  Listener listener(replay.participant);
  replay.coordinator().expect_reader("/patch_map");
  replay.coordinator().expect_reader("/localization_health");
  replay.play(hall().observations);
  Outcome outcome;
  outcome.lost = listener.lost_of(hall().observations.size());
  outcome.maps = listener.maps();
  replay.finish(out);
  return outcome;
}

/// The doors of three_doors.yaml, each in the middle of its opening.
bool is_at_a_door(const patch::Submap& submap) {
  return std::any_of(std::begin(kDoorsX), std::end(kDoorsX), [&](double x) {
    return submap.rect.contains(cell_at({x, 3.0}, 0.05));
  });
}

/// Nothing stands in the opening.
bool is_open(const patch::Submap& submap, const patch::Configuration& configuration) {
  for (const double x : kDoorsX) {
    if (!submap.rect.contains(cell_at({x, 3.0}, 0.05))) continue;
    for (double y = 2.85; y < 3.16; y += 0.05) {
      if (is_occupied(configuration.reflection.get(cell_at({x, y}, 0.05)))) return false;
    }
  }
  return true;
}

/// What was believed of each sub-map at the end.
std::map<int, std::vector<double>> last_states(const fs::path& path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  std::map<int, std::vector<double>> states;
  while (std::getline(in, line)) {
    int submap = 0;
    int configuration = 0;
    double probability = 0.0;
    double stamp = 0.0;
    EXPECT_EQ(
        std::sscanf(line.c_str(), "%lf,%d,%d,%lf", &stamp, &submap, &configuration, &probability),
        4);
    std::vector<double>& of = states[submap];
    of.resize(std::max(of.size(), static_cast<std::size_t>(configuration) + 1));
    of[static_cast<std::size_t>(configuration)] = probability;
  }
  return states;
}

TEST(OnlineLearning, OpenedDoorsBecomeConfigurationsAndTheRobotStaysLocalized) {
  const test::TemporaryDirectory one;
  const Outcome outcome = replay(one.path(), 1);
  EXPECT_EQ(outcome.lost, 0U);
  // The map gained sub-maps while the robot drove, each at a door, with both of its states.
  ASSERT_FALSE(outcome.maps.empty());
  EXPECT_TRUE(std::is_sorted(
      outcome.maps.begin(), outcome.maps.end(),
      [](const auto& a, const auto& b) { return a.submaps.size() < b.submaps.size(); }));
  const patch::PatchMap& last = outcome.maps.back();
  EXPECT_EQ(last.submaps.size(), 3U);
  for (const patch::Submap& submap : last.submaps) {
    EXPECT_TRUE(is_at_a_door(submap));
    EXPECT_EQ(submap.configurations.size(), 2U);
  }
  // The localizer took them over and knows that the doors are open.
  const std::map<int, std::vector<double>> believed = last_states(one.path() / "states.csv");
  ASSERT_EQ(believed.size(), last.submaps.size());
  int known = 0;
  for (const auto& [submap, probability] : believed) {
    const patch::Submap& at = last.submaps[static_cast<std::size_t>(submap)];
    for (std::size_t k = 0; k < probability.size(); ++k) {
      if (probability[k] <= 0.9) continue;
      ++known;
      EXPECT_TRUE(is_open(at, at.configurations[k])) << submap << " " << k;
    }
  }
  EXPECT_GE(known, 2) << "the east door was learned after it was last seen";
  const auto trajectory = log::read_trajectory(one.path() / "trajectory.tum");
  ASSERT_EQ(trajectory.size(), hall().truth.size());
  double sum_m = 0.0;
  double max_m = 0.0;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const double error_m = translation_distance(trajectory[i].pose, hall().truth[i]);
    sum_m += error_m;
    max_m = std::max(max_m, error_m);
  }
  // The bars: 3 cm and half a cell where nothing changes, 0.15 m where something does.
  EXPECT_LE(sum_m / static_cast<double>(trajectory.size()), 0.055);
  EXPECT_LE(max_m, 0.15);
  // The same bytes with two threads.
  const test::TemporaryDirectory two;
  (void)replay(two.path(), 2);
  for (const char* file : {"trajectory.tum", "states.csv", "patches.pgm"}) {
    const std::string expected = test::bytes_of(one.path() / file);
    EXPECT_FALSE(expected.empty()) << file;
    EXPECT_EQ(test::bytes_of(two.path() / file), expected) << file;
  }
}

/// The west door lies where nothing is to be learned, the middle one where nothing is to change.
TEST(OnlineLearning, LearnsNothingOfDoorsInZonesThatForbidIt) {
  const test::TemporaryDirectory folder;
  const fs::path zones = folder.path() / "zones.geojson";
  std::ofstream(zones) << R"({"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": {"name": "a", "kind": "learn", "control": "never_learn"},
     "geometry": {"type": "Polygon",
                  "coordinates": [[[2.2, 1.9], [3.9, 1.9], [3.9, 4.1], [2.2, 4.1], [2.2, 1.9]]]}},
    {"type": "Feature", "properties": {"name": "b", "kind": "learn", "control": "static_only"},
     "geometry": {"type": "Polygon",
                  "coordinates": [[[8.2, 1.9], [9.9, 1.9], [9.9, 4.1], [8.2, 4.1], [8.2, 1.9]]]}}
  ]})";
  const Outcome outcome = replay(folder.path() / "out", 2, zones.string());
  EXPECT_EQ(outcome.lost, 0U);
  const patch::PatchMap end = *maps::read_maps(folder.path() / "out").patches;
  ASSERT_EQ(end.submaps.size(), 1U) << "with both of the others there are three";
  EXPECT_TRUE(end.submaps[0].rect.contains(cell_at({kDoorsX[2], 3.0}, 0.05)));
  for (const patch::PatchMap& map : outcome.maps) {
    for (const patch::Submap& submap : map.submaps) {
      EXPECT_FALSE(submap.rect.contains(cell_at({kDoorsX[0], 3.0}, 0.05)));
      EXPECT_FALSE(submap.rect.contains(cell_at({kDoorsX[1], 3.0}, 0.05)));
    }
  }
}

}  // namespace
}  // namespace strata::patch_learner
