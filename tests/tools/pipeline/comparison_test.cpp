// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/comparison.hpp"

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

TEST(PairedTests, FiveSeedsCannotDecideAndTheVerdictSaysSo) {
  const Comparison comparison = compared(
      {model_of("a", {0.1, 0.1, 0.1, 0.1, 0.1}), model_of("b", {0.9, 0.8, 0.9, 0.8, 0.7})});
  const std::vector<PairedTest> tests = paired_tests(comparison);
  EXPECT_FALSE(tests[0].significant);
  EXPECT_NE(verdict(comparison, tests).find("--seeds 20"), std::string::npos);
}

TEST(ComparisonJson, HasTheShapeOfTheContract) {
  Comparison comparison = compared({model_of("patch", {0.1, 0.2})});
  comparison.train_s = {0.0, 60.0};
  comparison.test_s = {60.0, 100.0};
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

}  // namespace
}  // namespace strata::pipeline
