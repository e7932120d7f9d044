// SPDX-License-Identifier: Apache-2.0
/// The program itself: what `strata simulate` writes is what was simulated.
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/log/log_reader.hpp"
#include "components/log/trajectory_file.hpp"
#include "tests/support/test_data.hpp"
#include "tools/simulate/simulation.hpp"

namespace fs = std::filesystem;

namespace strata::simulate {
namespace {

const std::string kScenario = std::string(STRATA_SCENARIO_DIR) + "/empty_room.yaml";

/// The exit code; standard error goes to `errors`.
int run_simulate(const std::string& arguments, const fs::path& errors) {
  const std::string command = std::string(STRATA_PROGRAM) + " simulate " + arguments + " 2> '" +
                              errors.string() + "' > /dev/null";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(VerbSimulate, WritesLogBagAndTruthOfTheSameScans) {
  const test::TemporaryDirectory folder;
  const fs::path out = folder.path() / "out";
  ASSERT_EQ(run_simulate(kScenario + " --seed 5 --per-day --out '" + out.string() + "'",
                         folder.path() / "errors"),
            0)
      << test::bytes_of(folder.path() / "errors");
  EXPECT_TRUE(fs::exists(out / "states.json"));
  EXPECT_TRUE(fs::exists(out / "world.png"));

  const Simulation simulation = simulate(load_scenario(kScenario), 5);
  const auto carmen = log::read_observations(out / "log.clf");
  const auto bag = log::read_observations(out / "bag");
  const auto truth = log::read_trajectory(out / "truth.tum");
  std::size_t i = 0;
  for (std::size_t day = 0; day < simulation.days.size(); ++day) {
    const fs::path alone = out / ("day_" + std::to_string(day + 1));
    EXPECT_EQ(log::read_observations(alone / "log.clf").size(), simulation.days[day].scans.size());
    EXPECT_EQ(log::read_observations(alone / "bag").size(), simulation.days[day].scans.size());
    for (const SimulatedScan& scan : simulation.days[day].scans) {
      ASSERT_LT(i, std::min({carmen.size(), bag.size(), truth.size()}));
      const Scan& expected = scan.observation.scan;
      EXPECT_EQ(bag[i].scan.ranges_m, expected.ranges_m) << "bit for bit";
      EXPECT_EQ(carmen[i].scan.ranges_m, expected.ranges_m) << "bit for bit";
      EXPECT_EQ(bag[i].scan.stamp, expected.stamp);
      EXPECT_EQ(carmen[i].scan.stamp, expected.stamp);
      EXPECT_LT(translation_distance(bag[i].odom_from_robot, scan.observation.odom_from_robot),
                1e-9);
      EXPECT_LT(translation_distance(carmen[i].odom_from_robot, scan.observation.odom_from_robot),
                1e-9);
      EXPECT_NEAR(bag[i].scan.robot_from_laser.x, 0.1, 1e-9);
      EXPECT_NEAR(carmen[i].scan.robot_from_laser.x, 0.1, 1e-6);
      EXPECT_EQ(truth[i].stamp, expected.stamp);
      EXPECT_LT(translation_distance(truth[i].pose, scan.map_from_robot), 1e-6);
      ++i;
    }
  }
  EXPECT_EQ(i, carmen.size());
  EXPECT_EQ(i, bag.size());
  EXPECT_EQ(i, truth.size());
}

TEST(VerbSimulate, LeavesNothingBehindWhenTheScenarioIsWrong) {
  const test::TemporaryDirectory folder;
  const fs::path out = folder.path() / "out";
  const fs::path errors = folder.path() / "errors";
  EXPECT_EQ(run_simulate(kScenario + " --set laser.beems=3 --out '" + out.string() + "'", errors),
            2);
  EXPECT_EQ(test::bytes_of(errors),
            "strata simulate: error: --set laser.beems: laser.beems is an unknown key; did you "
            "mean 'beams'?\n");
  EXPECT_FALSE(fs::exists(out));
  EXPECT_EQ(
      run_simulate("'" + (folder.path() / "none.yaml").string() + "' --out '" + out.string() + "'",
                   errors),
      2);
  EXPECT_THAT(test::bytes_of(errors), testing::HasSubstr("none.yaml: cannot be read; check that"));
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace strata::simulate
