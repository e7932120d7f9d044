// SPDX-License-Identifier: Apache-2.0
/// lifelong.yaml as a robot runs it: three days of an office over DDS, not in lockstep, with no
/// maps at the beginning, killed in the middle of the second and of the third day.
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <signal.h>

#include "components/maps/earlier_runs.hpp"
#include "components/maps/maps_folder.hpp"
#include "tests/across/lifelong/live_robot.hpp"
#include "tests/across/lifelong/map_quality.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/test_data.hpp"
#include "tools/pipeline/learn.hpp"
#include "tools/simulate/random_office.hpp"

namespace fs = std::filesystem;

namespace strata::test {
namespace {

constexpr auto kPatience = std::chrono::seconds(60);
constexpr int kSensorReaders = 2;  // scan matcher and localizer
constexpr std::uint64_t kSeeds[] = {1, 2, 3};

/// STRATA_LIFELONG_SEED, STRATA_LIFELONG_SPEEDUP: of another drive, for figures.
double setting(const char* name, double otherwise) {
  const char* const text = std::getenv(name);
  return text != nullptr ? std::atof(text) : otherwise;
}

enum class Office { kOfFile, kAtRandom };

simulate::ScenarioConfig scenario_of(Office office, std::uint64_t seed) {
  if (office == Office::kAtRandom) return simulate::random_office(seed, {.days = 4});
  return simulate::load_scenario(STRATA_SCENARIO_DIR "/office.yaml", {"days=4"});
}

class Lifelong : public testing::TestWithParam<Office> {
 protected:
  Lifelong() {
    const auto seed = static_cast<std::uint64_t>(setting("STRATA_LIFELONG_SEED", 31));
    simulation_ = simulate::simulate(scenario_of(GetParam(), seed), seed);
    for (std::size_t day = 0; day + 1 < simulation_.days.size(); ++day) {
      for (const simulate::SimulatedScan& scan : simulation_.days[day].scans) {
        scans_.push_back(scan);
        truth_[scan.observation.scan.stamp.ns] = scan.map_from_robot;
      }
      ends_.push_back(scans_.size());
    }
  }

  [[nodiscard]] std::unique_ptr<ChildProcess> run() const {
    const std::string command = "cd '" + folder_.path().string() +
                                "' && exec '" STRATA_PROGRAM "' run '" STRATA_COMPOSITION_DIR
                                "/lifelong.yaml' --set "
                                "transport=loopback --set domain=" +
                                std::to_string(own_domain());
    return std::make_unique<ChildProcess>(std::vector<std::string>{"sh", "-c", command},
                                          std::vector<std::string>{},
                                          ChildProcess::Errors::kMerged);
  }
  [[nodiscard]] fs::path maps() const { return folder_.path() / "lifelong" / "maps"; }
  [[nodiscard]] MapQuality live_quality() const {
    return judge(maps::read_maps(maps()), maps::read_earlier_runs(maps()).scans, truth_,
                 simulation_.days.back(), kSeeds);
  }
  /// Of the same days, in one go.
  [[nodiscard]] MapQuality learned_quality() const {
    std::vector<Observation> observations;
    for (const simulate::SimulatedScan& scan : scans_) observations.push_back(scan.observation);
    const pipeline::LearnResult learned =
        pipeline::learn(observations, {}, {}, {.patch = true, .timescale = false}, 1, 2, nullptr);
    maps::Maps maps;
    maps.occupancy = learned.slam.occupancy;
    maps.filtered = learned.slam.filtered;
    maps.patches = learned.patches;
    return judge(maps, learned.slam.scans, truth_, simulation_.days.back(), kSeeds);
  }

  const TemporaryDirectory folder_;
  simulate::Simulation simulation_;
  std::vector<simulate::SimulatedScan> scans_;  // of the first three days
  std::vector<std::size_t> ends_;               // of the days
  Truth truth_;
};

void print(const char* name, const MapQuality& quality) {
  std::cout << name << ": " << quality.scans << " scans, trajectory " << quality.trajectory_m
            << " m, next day " << quality.localization_m << " m, lost " << quality.lost << ", "
            << quality.submaps << " sub-maps\n";
}

TEST_P(Lifelong, ThreeDaysWithTwoKillsGiveMapsAsGoodAsThoseOfLearn) {
  LiveRobot robot(make_participant(), scans_, setting("STRATA_LIFELONG_SPEEDUP", 6.0));
  auto process = run();
  ASSERT_TRUE(robot.is_heard_by(kSensorReaders, kPatience));
  robot.drive_until((ends_[0] + ends_[1]) / 2);
  process->kill_hard();
  process = run();  // and the robot drives on
  robot.drive_until((ends_[1] + ends_[2]) / 2);
  process->kill_hard();
  process = run();
  robot.drive_until(ends_[2]);
  EXPECT_GT(robot.lost(), 0U);
  EXPECT_GT(robot.repeated(), 0U);
  process->send(SIGINT);
  const std::string said = process->rest();
  EXPECT_EQ(process->wait(), 0) << said;

  const MapQuality live = live_quality();
  const MapQuality learned = learned_quality();
  print("live", live);
  print("learn", learned);
  EXPECT_LT(live.trajectory_m, learned.trajectory_m + 0.03);
  EXPECT_LT(live.localization_m, learned.localization_m + 0.03);
  EXPECT_LT(live.lost, learned.lost + 0.01);
}

INSTANTIATE_TEST_SUITE_P(InAnOffice, Lifelong, testing::Values(Office::kOfFile, Office::kAtRandom),
                         [](const auto& office) {
                           return office.param == Office::kAtRandom ? "DrawnAtRandom" : "OfAFile";
                         });

}  // namespace
}  // namespace strata::test
