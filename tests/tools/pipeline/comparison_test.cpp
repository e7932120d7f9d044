// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/comparison.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace strata::pipeline {
namespace {

ModelResult model_of(const std::string& name, const std::vector<double>& means_m) {
  ModelResult model;
  model.model = name;
  for (std::size_t i = 0; i < means_m.size(); ++i) {
    ModelRun run;
    run.seed = i + 1;
    run.metrics.error_m.mean = means_m[i];
    model.runs.push_back(run);
  }
  return model;
}

Comparison compared(std::vector<ModelResult> models) {
  Comparison comparison;
  comparison.models = std::move(models);
  comparison.seeds = comparison.models.front().runs.size();
  comparison.parts.resize(1);
  return comparison;
}

TEST(PairedTests, FindAConsistentDifference) {
  const Comparison comparison =
      compared({model_of("occupancy", {0.50, 0.52, 0.61, 0.58, 0.49, 0.55, 0.60, 0.57}),
                model_of("patch", {0.10, 0.12, 0.11, 0.14, 0.09, 0.15, 0.10, 0.13})});
  const std::vector<PairedTest> tests = paired_tests(comparison);
  ASSERT_EQ(tests.size(), 1U);
  EXPECT_EQ(tests[0].better, "patch");
  EXPECT_TRUE(tests[0].significant);
  EXPECT_NEAR(tests[0].p, 2.0 / 256.0, 1e-12);  // all eight of one sign
  EXPECT_NE(verdict(comparison, tests).find("significantly below occupancy"), std::string::npos);
}

TEST(PairedTests, SayNothingOfNoise) {
  const Comparison comparison = compared({model_of("a", {0.1, 0.3, 0.2, 0.4, 0.2, 0.3, 0.1}),
                                          model_of("b", {0.2, 0.2, 0.3, 0.3, 0.3, 0.2, 0.1})});
  const std::vector<PairedTest> tests = paired_tests(comparison);
  EXPECT_FALSE(tests[0].significant);
  EXPECT_NE(verdict(comparison, tests).find("no difference that matters"), std::string::npos);
}

TEST(PairedTests, DifferencesBelowHalfACellAreNoVerdict) {
  const Comparison comparison =
      compared({model_of("a", {0.040, 0.041, 0.042, 0.040, 0.041, 0.042, 0.041, 0.040}),
                model_of("b", {0.033, 0.034, 0.034, 0.033, 0.033, 0.034, 0.034, 0.033})});
  const std::vector<PairedTest> tests = paired_tests(comparison);
  EXPECT_TRUE(tests[0].significant);
  const std::string text = verdict(comparison, tests);
  EXPECT_NE(text.find("equal for practical purposes"), std::string::npos);
  EXPECT_NE(text.find("no difference that matters"), std::string::npos);
}

TEST(PairedTests, TheVerdictSaysWhenEvenTheBestWasLost) {
  Comparison comparison =
      compared({model_of("a", {1.0, 1.1, 1.2, 1.3}), model_of("b", {2, 2, 2, 2})});
  EXPECT_EQ(verdict(comparison, paired_tests(comparison)).find("lost"), std::string::npos);
  for (std::size_t i = 0; i < 3; ++i) comparison.models[0].runs[i].metrics.lost = true;
  EXPECT_NE(verdict(comparison, paired_tests(comparison)).find("Even it was lost in 3 of 4 runs"),
            std::string::npos);
}

TEST(PairedTests, TheVerdictSaysWhoGotLostMoreOftenWhateverTheMeans) {
  Comparison comparison = compared({model_of("a", {0.30, 0.31, 0.32, 0.33, 0.30, 0.31, 0.32, 0.33}),
                                    model_of("b", {0.29, 0.30, 0.31, 0.32, 0.9, 0.9, 0.9, 0.9})});
  EXPECT_EQ(verdict(comparison, paired_tests(comparison)).find("lost"), std::string::npos);
  for (ModelRun& run : comparison.models[1].runs) run.metrics.lost = true;
  const std::string text = verdict(comparison, paired_tests(comparison));
  EXPECT_NE(text.find("b got lost in 8 of 8 runs, a in 0"), std::string::npos) << text;
  EXPECT_EQ(text.find("no difference that matters"), std::string::npos) << text;
  // Three more lost runs of eight are not beyond chance.
  for (std::size_t i = 3; i < 8; ++i) comparison.models[1].runs[i].metrics.lost = false;
  EXPECT_EQ(verdict(comparison, paired_tests(comparison)).find("got lost"), std::string::npos);
}

TEST(PairedTests, FiveSeedsCannotDecideAndTheVerdictSaysSo) {
  const Comparison comparison = compared(
      {model_of("a", {0.1, 0.1, 0.1, 0.1, 0.1}), model_of("b", {0.9, 0.8, 0.9, 0.8, 0.7})});
  const std::vector<PairedTest> tests = paired_tests(comparison);
  EXPECT_FALSE(tests[0].significant);
  EXPECT_NE(verdict(comparison, tests).find("--seeds 20"), std::string::npos);
}

TEST(PairedTests, SevenSeedsCannotDecideSixPairsAndTheVerdictSaysSo) {
  const std::vector<double> good{0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1};
  const std::vector<double> bad{0.9, 0.8, 0.9, 0.8, 0.7, 0.9, 0.8};
  const Comparison few =
      compared({model_of("a", good), model_of("b", bad), model_of("c", bad), model_of("d", bad)});
  EXPECT_NE(verdict(few, paired_tests(few)).find("--seeds 20"), std::string::npos);
  const Comparison pair = compared({model_of("a", good), model_of("b", bad)});
  EXPECT_EQ(verdict(pair, paired_tests(pair)).find("--seeds 20"), std::string::npos);
}

TEST(ComparisonJson, HasTheShapeOfTheContract) {
  Comparison comparison = compared({model_of("patch", {0.1, 0.2})});
  comparison.parts[0].train_s = {0.0, 60.0};
  comparison.parts[0].test_s = {60.0, 100.0};
  const nlohmann::json json = to_json(comparison, paired_tests(comparison));
  EXPECT_EQ(json["train"][1], 60.0);
  EXPECT_EQ(json["seeds"], 2);
  const nlohmann::json& patch = json["models"]["patch"];
  EXPECT_NEAR(patch["error_m"]["mean"].get<double>(), 0.15, 1e-12);
  for (const char* key : {"mean", "median", "p95", "ci95"}) {
    EXPECT_TRUE(patch["error_m"].contains(key)) << key;
  }
  for (const char* key : {"failure_rate", "scan_prediction", "map_bytes", "update_ms",
                          "adaptation_s", "adaptation_scans", "recall_old_state"}) {
    EXPECT_TRUE(patch.contains(key)) << key;
  }
  EXPECT_TRUE(json.contains("wins"));
}

TEST(PairedTests, CountTheUnitsThatOnlyOneModelLost) {
  Comparison comparison = compared({model_of("a", {0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1}),
                                    model_of("b", {2.0, 2.1, 2.2, 2.3, 2.4, 2.5, 2.6, 2.7})});
  for (ModelRun& run : comparison.models[1].runs) run.metrics.lost = true;
  comparison.models[0].runs[0].metrics.lost = true;
  const PairedTest test = paired_tests(comparison).front();
  EXPECT_EQ(test.lost_only_better, 0U);
  EXPECT_EQ(test.lost_only_worse, 7U);
  EXPECT_NEAR(test.p_lost, 2.0 / 128.0, 1e-12);
  EXPECT_EQ(test.cliffs_delta, 1.0);
}

EventOutcome outcome_after(std::optional<double> scans) {
  EventOutcome outcome;
  outcome.adapted_after_scans = scans;
  if (scans) outcome.adapted_after_s = 0.2 * *scans;
  return outcome;
}

TEST(Adaptation, NeverIsLongerThanAnyDelay) {
  ModelResult model = model_of("patch", {0.1});
  model.scores.resize(2);
  model.scores[0].events = {outcome_after(0.0), outcome_after(4.0)};
  model.scores[1].events = {outcome_after(std::nullopt)};
  AdaptationSummary summary = summarize_adaptation(model);
  EXPECT_EQ(summary.events, 3U);
  EXPECT_EQ(summary.adapted, 2U);
  EXPECT_EQ(summary.scans, 4.0);
  EXPECT_NEAR(*summary.s, 0.8, 1e-12);
  model.scores[1].events.push_back(outcome_after(std::nullopt));
  summary = summarize_adaptation(model);
  EXPECT_FALSE(summary.scans.has_value());  // half never: the median is not reached
}

TEST(SeedSpread, IsTheDistanceFromTheMeanOfTheSeeds) {
  ModelResult model = model_of("patch", {0.1, 0.1});
  EXPECT_NEAR(seed_spread_m(model_of("one", {0.1})).value_or(-1.0), -1.0, 0.0);
  model.runs[0].estimates = {{0.0, 0.0, 0.0}, {1.0, 1.0, 0.0}};
  model.runs[1].estimates = {{0.2, 0.0, 0.0}, {1.0, 1.4, 0.0}};
  EXPECT_NEAR(*seed_spread_m(model), 0.15, 1e-12);
}

TEST(FitInterval, IsThatOfTheDifferenceWhenAnotherModelIsGiven) {
  ModelResult a;
  ModelResult b;
  a.scores.resize(1);
  b.scores.resize(1);
  for (int i = 0; i < 300; ++i) {
    const double wave = std::sin(0.05 * i);  // the same scenes are hard for both
    a.scores[0].series.push_back({static_cast<double>(i), 10.0 * wave + 5.0, 10});
    b.scores[0].series.push_back({static_cast<double>(i), 10.0 * wave, 10});
  }
  const auto alone = fit_interval(a);
  const auto difference = fit_interval(a, &b);
  ASSERT_TRUE(alone && difference);
  EXPECT_GT(alone->high - alone->low, 0.1);
  EXPECT_NEAR(difference->low, 0.5, 1e-9);
  EXPECT_NEAR(difference->high, 0.5, 1e-9);
  a.scores[0].series.resize(40);
  EXPECT_FALSE(fit_interval(a).has_value());  // 40 s are no two blocks
}

}  // namespace
}  // namespace strata::pipeline
