// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/several_buildings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"

namespace strata::pipeline {
namespace {

Building building(const std::string& folder, double first_m, double second_m) {
  Building result{folder, {}};
  result.comparison.seeds = 8;
  result.comparison.log = folder + ".clf";
  result.comparison.parts.resize(1);
  result.comparison.parts[0].name = folder;
  for (const auto& [name, mean_m] :
       {std::pair("occupancy", first_m), std::pair("patch", second_m)}) {
    ModelResult model;
    model.model = name;
    model.map_bytes = 1000;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      ModelRun run;
      run.seed = seed;
      run.metrics.error_m.mean = mean_m + 0.001 * static_cast<double>(seed);
      run.errors.push_back({Stamp::from_seconds(1.0), run.metrics.error_m.mean, 0.0});
      run.sees_change.push_back(0);
      model.runs.push_back(std::move(run));
    }
    result.comparison.models.push_back(std::move(model));
  }
  return result;
}

TEST(SeveralBuildings, JoinTheirDrivesAsUnits) {
  const std::vector<Building> two{building("1_office", 0.30, 0.10), building("2_hall", 0.50, 0.20)};
  const Comparison joint = join(two);
  ASSERT_EQ(joint.parts.size(), 2U);
  EXPECT_EQ(joint.parts[1].name, "2_hall");
  ASSERT_EQ(joint.models.size(), 2U);
  EXPECT_EQ(joint.models[0].runs.size(), 16U);
  EXPECT_EQ(joint.models[0].runs[8].part, 1U);
  EXPECT_EQ(joint.models[0].map_bytes, 2000U);
  EXPECT_NEAR(mean_error_m(joint.models[0]), 0.4045, 1e-12);
  EXPECT_NEAR(mean_error_m(joint.models[1]), 0.1545, 1e-12);
}

TEST(SeveralBuildings, MustHaveTheSameModels) {
  std::vector<Building> two{building("1_office", 0.3, 0.1), building("2_hall", 0.5, 0.2)};
  two[1].comparison.models.pop_back();
  EXPECT_THROW(static_cast<void>(join(two)), InputError);
}

TEST(SeveralBuildings, StandInOneTableWithAVerdictEach) {
  const std::vector<Building> two{building("1_office", 0.10, 0.30), building("2_hall", 0.50, 0.10)};
  const test::TemporaryDirectory dir;
  write_joint_report(two, "settings: here\n", dir.path());
  const std::string page = test::bytes_of(dir.path() / "report.html");
  EXPECT_THAT(page, testing::HasSubstr("1_office: occupancy has the lowest mean error"));
  EXPECT_THAT(page, testing::HasSubstr("2_hall: patch has the lowest mean error"));
  const auto json = joint_json(two);
  EXPECT_EQ(json["buildings"].size(), 2U);
  EXPECT_EQ(json["buildings"][1]["folder"], "2_hall");
  EXPECT_EQ(json["parts"].size(), 2U);
}

}  // namespace
}  // namespace strata::pipeline
