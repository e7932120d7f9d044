// SPDX-License-Identifier: Apache-2.0
/// The localizer over DDS does what the direct path does.
#include "components/localizer/localizer.hpp"

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/localizer/register.hpp"
#include "components/maps/node_map_message.hpp"
#include "components/maps/refiner.hpp"
#include "components/runtime/composition.hpp"
#include "core/base/error.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/components/localizer/room_fixture.hpp"
#include "tests/components/player/lockstep_replay.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/test_data.hpp"
#include "tools/pipeline/localize.hpp"
#include "tools/pipeline/localize_output.hpp"

namespace fs = std::filesystem;

namespace strata::localizer {
namespace {

/// Somebody on the replay's own participant; called when the component is there, before the
/// coordinator connects.
using Bystander =
    std::function<void(const std::shared_ptr<bus::Participant>&, runtime::LockstepCoordinator&)>;

/// Replays the second day in lockstep; before the scan `restart_at`, somebody publishes a pose.
void replay(const std::string& parameters, const fs::path& out, int threads,
            std::optional<std::size_t> restart_at = {}, const Bystander& bystander = nullptr) {
  test::LockstepReplay replay(composition_of(parameters), {register_component}, kSeed, threads);
  const auto initial_pose =
      replay.coordinator().advertise<geometry_msgs::msg::PoseWithCovarianceStamped>("/initialpose");
  if (bystander) bystander(replay.participant, replay.coordinator());
  replay.play(room().observations, [&](std::size_t scan) {
    if (restart_at != scan) return;
    geometry_msgs::msg::PoseWithCovarianceStamped message;
    message.header().frame_id("map");
    message.pose(convert::to_pose_with_covariance(
        {Pose2{5.5, 3.5, 2.0}, Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal()}));
    initial_pose(message);
  });
  replay.finish(out);
}

void localize_directly(const std::string& model, bool global, const fs::path& out) {
  const maps::Maps maps = maps::read_maps(room().folder.path());
  localization::LocalizerConfig config;
  pipeline::LocalizationStart start;
  if (global) {
    config.global_start.max_particles = 3000;
  } else {
    start.map_from_robot =
        Pose2Gaussian{room().start, Eigen::Vector3d(0.2 * 0.2, 0.2 * 0.2, 0.1 * 0.1).asDiagonal()};
  }
  const maps::MapModel made = maps::make_map_model(maps, model, {});
  const auto refiner = maps::make_refiner(maps, *made.descriptor, {});
  const pipeline::LocalizationRun run =
      pipeline::localize(room().observations, {}, made, maps.filtered, config, start, kSeed, 1,
                         nullptr, nullptr, refiner.get());
  fs::create_directories(out);
  pipeline::write_localization(out, run, {model, kSeed, config.particles, {}, {}});
}

class LocalizerReplay : public ::testing::TestWithParam<std::pair<const char*, bool>> {};

TEST_P(LocalizerReplay, WritesTheVeryFilesOfTheDirectPath) {
  const auto& [model, global] = GetParam();
  const test::TemporaryDirectory out;
  localize_directly(model, global, out.path() / "direct");
  for (const int threads : {1, 2}) {
    const fs::path replayed = out.path() / ("replay" + std::to_string(threads));
    fs::create_directories(replayed);
    replay(parameters_of(model, global), replayed, threads);
    for (const char* file : {"trajectory.tum", "refined.tum", "states.csv"}) {
      const std::string direct = test::bytes_of(out.path() / "direct" / file);
      // The room looks nearly the same turned round: from nowhere the pose stays ambiguous, and
      // none is refined.
      EXPECT_EQ(direct.empty(), global && file == std::string("refined.tum"));
      EXPECT_EQ(test::bytes_of(replayed / file), direct) << file << ", threads " << threads;
    }
    auto expected = nlohmann::json::parse(test::bytes_of(out.path() / "direct" / "metrics.json"));
    expected["cost"] = nullptr;
    EXPECT_EQ(nlohmann::json::parse(test::bytes_of(replayed / "metrics.json")), expected);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, LocalizerReplay,
                         ::testing::Values(std::pair{"patch", false}, std::pair{"filtered", true},
                                           std::pair{"timescale", false}));

TEST(Localizer, StartsAgainFromAPublishedPose) {
  const test::TemporaryDirectory out;
  const std::size_t middle = room().observations.size() / 2;
  fs::create_directories(out.path() / "a");
  replay(parameters_of("filtered", false), out.path() / "a", 1);
  replay(parameters_of("filtered", false), out.path(), 1, middle);
  const auto undisturbed = log::read_trajectory(out.path() / "a" / "trajectory.tum");
  const auto restarted = log::read_trajectory(out.path() / "trajectory.tum");
  ASSERT_EQ(restarted.size(), undisturbed.size());
  EXPECT_EQ(restarted[middle - 1].pose, undisturbed[middle - 1].pose);
  EXPECT_LT(translation_distance(restarted[middle].pose, Pose2{5.5, 3.5, 2.0}), 0.1);
}

/// Replays the second day with the memory of the first on its topic, again every so many scans.
void replay_with_map_topics(const std::string& parameters, const fs::path& out,
                            std::size_t again_every) {
  test::LockstepReplay replay(composition_of(parameters), {register_component}, kSeed);
  const auto filtered =
      replay.coordinator().advertise<strata_msgs::msg::ReflectionGrid>("/reflection_filtered");
  const auto nodes = replay.coordinator().advertise<strata_msgs::msg::NodeMap>("/node_map");
  const maps::Maps maps = maps::read_maps(room().folder.path());
  replay.play(room().observations, [&](std::size_t scan) {
    if (scan == 0) filtered(convert::to_message(maps.filtered));
    if (scan % again_every != 0) return;
    nodes(maps::to_message(*maps.timescale, *maps.timescale->decode(), Stamp(), "map"));
  });
  replay.finish(out);
}

TEST(Localizer, LosesNothingThatItKnowsWhenItsMapComesAgain) {
  for (const char* where : {"start: {pose: [%X, %Y, %T]}",
                            // many places at once: no single pose could stand for them
                            "localizer: {global_start: {max_particles: 2000}}"}) {
    std::string parameters = std::string("{model: timescale, ") + where + "}";
    const std::pair<const char*, double> values[] = {
        {"%X", room().start.x}, {"%Y", room().start.y}, {"%T", room().start.theta}};
    for (const auto& [name, value] : values) {
      const std::size_t at = parameters.find(name);
      if (at != std::string::npos) parameters.replace(at, 2, std::to_string(value));
    }
    const test::TemporaryDirectory out;
    fs::create_directories(out.path() / "once");
    fs::create_directories(out.path() / "again");
    replay_with_map_topics(parameters, out.path() / "once", 1'000'000);
    replay_with_map_topics(parameters, out.path() / "again", 7);
    const std::string once = test::bytes_of(out.path() / "once" / "trajectory.tum");
    EXPECT_GT(once.size(), 1000U);
    EXPECT_EQ(test::bytes_of(out.path() / "again" / "trajectory.tum"), once);
  }
}

/// By so much the transform is dated after its scan.
constexpr Duration kTransformTolerance{1'000'000'000};

/// Takes a private hold of what goes out, by the scan's stamp.
class Listener {
 public:
  explicit Listener(const std::shared_ptr<bus::Participant>& participant)
      : pose_(participant, "/amcl_pose", bus::qos_profile("default").lossless(),
              [this](const geometry_msgs::msg::PoseWithCovarianceStamped& message) {
                const std::lock_guard lock(mutex_);
                poses_[convert::from_message(message.header().stamp())] =
                    planar(convert::from_message(message.pose().pose()));
                changed_.notify_all();
              }),
        tf_(participant, "/tf", bus::qos_profile("default").lossless(),
            [this](const tf2_msgs::msg::TFMessage& message) {
              const auto& transform = message.transforms().at(0);
              if (transform.child_frame_id() != "odom") return;
              const std::lock_guard lock(mutex_);
              map_from_odom_[convert::from_message(transform.header().stamp()) -
                             kTransformTolerance] =
                  planar(convert::from_message(transform.transform()));
              changed_.notify_all();
            }) {}

  /// Pose and map_from_odom of every stamp, when both of so many have come.
  [[nodiscard]] std::map<Stamp, std::pair<Pose2, Pose2>> wait_for_pairs(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::seconds(20),
                      [&] { return poses_.size() >= count && map_from_odom_.size() >= count; });
    std::map<Stamp, std::pair<Pose2, Pose2>> result;
    for (const auto& [stamp, pose] : poses_) {
      const auto found = map_from_odom_.find(stamp);
      if (found != map_from_odom_.end()) result[stamp] = {pose, found->second};
    }
    return result;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<Stamp, Pose2> poses_;
  std::map<Stamp, Pose2> map_from_odom_;
  bus::Reader<geometry_msgs::msg::PoseWithCovarianceStamped> pose_;
  bus::Reader<tf2_msgs::msg::TFMessage> tf_;
};

TEST(Localizer, TransformFromMapToOdometryCarriesTheOdometryToThePose) {
  const test::TemporaryDirectory out;
  std::optional<Listener> listener;
  replay(parameters_of("patch", false), out.path(), 1, {},
         [&](const auto& participant, runtime::LockstepCoordinator& coordinator) {
           listener.emplace(participant);
           coordinator.expect_reader("/amcl_pose");
           coordinator.expect_reader("/tf");
         });
  const auto pairs = listener->wait_for_pairs(room().observations.size());
  EXPECT_EQ(pairs.size(), room().observations.size());
  for (const Observation& observation : room().observations) {
    const auto found = pairs.find(observation.scan.stamp);
    ASSERT_NE(found, pairs.end());
    const auto& [pose, map_from_odom] = found->second;
    const Pose2 carried = map_from_odom * observation.odom_from_robot;
    EXPECT_NEAR(carried.x, pose.x, 1e-9);
    EXPECT_NEAR(carried.y, pose.y, 1e-9);
    EXPECT_NEAR(std::remainder(carried.theta - pose.theta, 2.0 * M_PI), 0.0, 1e-9);
  }
}

TEST(Localizer, AReplayThatHearsAStrangersScansEndsWithAnError) {
  std::optional<bus::Writer<sensor_msgs::msg::LaserScan>> stranger;
  const auto publish = [&](const auto& participant, runtime::LockstepCoordinator&) {
    stranger.emplace(participant, "/scan", bus::qos_profile("lossless"));
    stranger->publish(convert::to_message(room().observations[3].scan, "laser"));
  };
  const test::TemporaryDirectory out;
  try {
    replay(parameters_of("filtered", false), out.path(), 1, {}, publish);
    FAIL() << "it replayed on";
  } catch (const Error& told) {
    EXPECT_EQ(told.place(), "/scan");
    EXPECT_THAT(told.what(), testing::HasSubstr("somebody else publishes it"));
  }
}

TEST(CompositionOverride, ReachesTheParametersOfTheNamedComponent) {
  const test::TemporaryDirectory folder;
  const fs::path file = folder.path() / "c.yaml";
  std::ofstream(file) << "version: 1\nprocesses:\n  - name: main\n    components:\n"
                         "      - {type: strata::Player, name: player}\n"
                         "      - {type: strata::Localizer, name: localizer, "
                         "parameters: {maps: old, model: filtered}}\n";
  const runtime::Composition composition =
      runtime::load_composition(file, {"localizer.maps=new", "player.start.speed=2", "domain=42"});
  EXPECT_EQ(composition.network.domain, 42);
  const auto& components = composition.processes.at(0).components;
  EXPECT_EQ(components.at(0).parameters["start"]["speed"].as<int>(), 2);
  EXPECT_EQ(components.at(1).parameters["maps"].as<std::string>(), "new");
  EXPECT_EQ(components.at(1).parameters["model"].as<std::string>(), "filtered");
  EXPECT_THROW((void)runtime::load_composition(file, {"localiser.maps=new"}), ConfigError);
}

}  // namespace
}  // namespace strata::localizer
