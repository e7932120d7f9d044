// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/compare.hpp"

#include <algorithm>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/pipeline/simulated_room.hpp"
#include "tools/pipeline/comparison_report.hpp"

namespace strata::pipeline {
namespace {

using testing::HasSubstr;

const std::vector<std::uint64_t> kSeeds{11, 12, 13};

CompareOutcome compare_room(const Runs& runs, int threads) {
  CompareJob job;
  job.log = "empty_room";
  job.splits = {split_by_time(runs, "room", 0.6 * elapsed_seconds(runs.observations).back())};
  job.seeds = kSeeds;
  job.threads = threads;
  job.jobs = threads;
  CompareConfig config;
  config.protocol.memory_steps = 0;
  return compare(runs, config, job);
}

struct Row {
  std::string model;
  std::string seed;
  double error_m = 0.0;
};

std::vector<Row> read_errors(const std::string& csv) {
  std::istringstream in(csv);
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "model,part,seed,time_s,error_m,error_rad,changed");
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    Row row;
    std::string part;
    std::string time_s;
    std::string error_m;
    std::getline(fields, row.model, ',');
    std::getline(fields, part, ',');
    std::getline(fields, row.seed, ',');
    std::getline(fields, time_s, ',');
    std::getline(fields, error_m, ',');
    row.error_m = std::stod(error_m);
    rows.push_back(row);
  }
  return rows;
}

/// Per model: the mean over its seeds of each seed's mean.
std::map<std::string, double> means_of(const std::vector<Row>& rows) {
  std::map<std::string, std::map<std::string, std::pair<double, int>>> sums;
  for (const Row& row : rows) {
    auto& [sum, count] = sums[row.model][row.seed];
    sum += row.error_m;
    ++count;
  }
  std::map<std::string, double> means;
  for (const auto& [model, seeds] : sums) {
    EXPECT_EQ(seeds.size(), kSeeds.size()) << model;
    for (const auto& [seed, sum] : seeds) {
      means[model] += sum.first / sum.second / static_cast<double>(seeds.size());
    }
  }
  return means;
}

TEST(Compare, WritesAReportWhoseMeansFollowFromItsErrors) {
  const Runs runs = test_room::simulate_runs(2, 2);
  const CompareOutcome outcome = compare_room(runs, 2);
  const test::TemporaryDirectory dir;
  write_report(outcome, "protocol:\n  train_share: 0.6\n", dir.path());

  const std::string page = test::bytes_of(dir.path() / "report.html");
  const auto json = nlohmann::json::parse(test::bytes_of(dir.path() / "comparison.json"));
  const std::vector<Row> rows = read_errors(test::bytes_of(dir.path() / "errors.csv"));
  const std::map<std::string, double> means = means_of(rows);
  ASSERT_EQ(means.size(), 4U);
  std::size_t errors = 0;
  for (const ModelResult& model : outcome.comparison.models) {
    SCOPED_TRACE(model.model);
    ASSERT_EQ(means.count(model.model), 1U);
    EXPECT_NEAR(json["models"][model.model]["error_m"]["mean"].get<double>(), means.at(model.model),
                1e-8);
    EXPECT_THAT(page, HasSubstr(model.model));
    for (const ModelRun& run : model.runs) errors += run.errors.size();
  }
  EXPECT_EQ(rows.size(), errors);
  EXPECT_THAT(page, HasSubstr("train_share: 0.6"));
  EXPECT_THAT(page, HasSubstr("Errors are against given poses."));
  EXPECT_TRUE(std::filesystem::exists(dir.path() / "error_over_time.png"));
}

TEST(Compare, WritesWhenEachErrorWasAlsoWithStampsOfALog) {
  Comparison comparison;
  ModelResult& model = comparison.models.emplace_back();
  model.model = "patch";
  ModelRun& run = model.runs.emplace_back();
  run.seed = 7;
  run.errors = {{Stamp{976'054'472'687'446'000}, 0.25, 0.5, 1.0},
                {Stamp{1'500'000}, 0.5, 0.0, 1.0}};
  run.sees_change = {0, 1};
  const test::TemporaryDirectory dir;
  write_series(comparison, dir.path());
  EXPECT_EQ(test::bytes_of(dir.path() / "errors.csv"),
            "model,part,seed,time_s,error_m,error_rad,changed\n"
            "patch,0,7,976054472.687446,0.25,0.5,0\n"
            "patch,0,7,0.001500,0.5,0,1\n");
}

TEST(Compare, TestsOnWhatItDidNotLearnFrom) {
  const Runs runs = test_room::simulate_runs(2, 2);
  const CompareOutcome outcome = compare_room(runs, 2);
  const std::vector<double> elapsed = elapsed_seconds(runs.observations);
  const Stamp last_learned = outcome.learned.slam.scans.back().scan.stamp;
  const std::size_t learned = outcome.learned.slam.scans.size();
  EXPECT_EQ(outcome.comparison.parts.at(0).train_s[1], elapsed[learned - 1]);
  EXPECT_EQ(outcome.comparison.parts.at(0).test_s[0], elapsed[learned]);
  EXPECT_LE(elapsed[learned - 1], 0.6 * elapsed.back());
  EXPECT_GT(elapsed[learned], 0.6 * elapsed.back());
  for (const ModelResult& model : outcome.comparison.models) {
    for (std::size_t s = 0; s < kSeeds.size(); ++s) {
      EXPECT_EQ(model.runs[s].seed, kSeeds[s]);
      EXPECT_EQ(model.runs[s].errors.size(), runs.observations.size() - learned);
      EXPECT_GT(model.runs[s].errors.front().stamp, last_learned);
    }
  }
}

TEST(Compare, GivesTheSameErrorsWithAnyNumberOfThreads) {
  const Runs runs = test_room::simulate_runs(2, 2);
  const CompareOutcome one = compare_room(runs, 1);
  const CompareOutcome other = compare_room(runs, 8);
  ASSERT_EQ(one.comparison.models.size(), other.comparison.models.size());
  for (std::size_t m = 0; m < one.comparison.models.size(); ++m) {
    const ModelResult& a = one.comparison.models[m];
    const ModelResult& b = other.comparison.models[m];
    EXPECT_EQ(a.scores[0].overall.log_likelihood_per_beam,
              b.scores[0].overall.log_likelihood_per_beam);
    for (std::size_t s = 0; s < kSeeds.size(); ++s) {
      ASSERT_EQ(a.runs[s].errors.size(), b.runs[s].errors.size());
      for (std::size_t i = 0; i < a.runs[s].errors.size(); ++i) {
        ASSERT_EQ(a.runs[s].errors[i].error_m, b.runs[s].errors[i].error_m) << a.model;
      }
    }
  }
}

TEST(Compare, RefusesASplitThatLeavesNothing) {
  const Runs runs = test_room::simulate_runs(2, 1);
  CompareJob job;
  job.seeds = kSeeds;
  for (const double until_s : {1e6, -1.0}) {
    job.splits = {split_by_time(runs, "log", until_s)};
    EXPECT_THROW(static_cast<void>(compare(runs, {}, job)), InputError);
  }
}

TEST(Compare, CountsScansTakenWhereNothingWasLearned) {
  Runs runs = test_room::simulate_located_runs(2, 2);
  runs.truths.assign(runs.truths.size(), std::nullopt);
  CompareConfig config;
  config.protocol.models = {"occupancy"};
  config.protocol.memory_steps = 0;
  CompareJob job;
  job.seeds = {1};
  job.splits = {split_by_time(runs, "room", 0.6 * elapsed_seconds(runs.observations).back())};
  EXPECT_EQ(compare(runs, config, job).comparison.parts.at(0).unmapped_scans, 0U);
  // The last day is said to have been in another room.
  for (const std::size_t i : job.splits[0].test)
    runs.poses[i] = Pose2{50.0, 0.0, 0.0} * *runs.poses[i];
  const TestPartInfo part = compare(runs, config, job).comparison.parts.at(0);
  EXPECT_EQ(part.unmapped_scans, part.scans);
}

TEST(Folds, TestEachScanOnceOnMapsOfTheOthers) {
  const Runs runs = test_room::simulate_runs(2, 3);
  const std::vector<std::vector<std::string>> ways{{"one"}, {"one", "two", "three"}};
  for (const auto& logs : ways) {
    std::vector<int> tested(runs.observations.size(), 0);
    for (const Split& split : make_folds(runs, logs, 3)) {
      EXPECT_EQ(split.train.size() + split.test.size(), runs.observations.size());
      EXPECT_FALSE(split.test.empty());
      for (const std::size_t i : split.test) {
        ++tested[i];
        EXPECT_FALSE(std::binary_search(split.train.begin(), split.train.end(), i));
      }
    }
    EXPECT_EQ(std::count(tested.begin(), tested.end(), 1),
              static_cast<std::ptrdiff_t>(tested.size()));
  }
  EXPECT_THROW(static_cast<void>(make_folds(runs, {"one", "two"}, 3)), InputError);
}

TEST(Folds, GiveOneUnitAFoldAndSeed) {
  const Runs runs = test_room::simulate_located_runs(2, 2);
  CompareConfig config;
  config.protocol.models = {"occupancy", "timescale_mixture"};
  config.protocol.memory_steps = 0;
  CompareJob job;
  job.splits = make_folds(runs, {"one", "two"}, 2);
  job.seeds = {1, 2};
  job.jobs = 2;
  const Comparison comparison = compare(runs, config, job).comparison;
  ASSERT_EQ(comparison.parts.size(), 2U);
  EXPECT_EQ(comparison.parts[0].name, "one");
  EXPECT_EQ(comparison.parts[1].name, "two");
  for (const ModelResult& model : comparison.models) {
    ASSERT_EQ(model.runs.size(), 4U);
    EXPECT_EQ(model.runs[2].part, 1U);
    EXPECT_EQ(model.runs[2].seed, 1U);
    EXPECT_LT(mean_error_m(model), 0.5);
  }
}

}  // namespace
}  // namespace strata::pipeline
