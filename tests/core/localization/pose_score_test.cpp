// SPDX-License-Identifier: Apache-2.0
#include "core/localization/pose_score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/localization/likelihood_field_model.hpp"
#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/localization/score_calibration.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "tests/core/localization/box_map.hpp"

namespace strata::localization {
namespace {

using test::BoxWorld;
using test::Drive;
using test::room;

/// A corridor without a mark between its ends, 30 m long.
BoxWorld corridor() {
  return {
      {0.0, 0.0, 30.0, 0.3}, {0.0, 2.2, 30.0, 2.5}, {0.0, 0.0, 0.3, 2.5}, {29.7, 0.0, 30.0, 2.5}};
}

ReflectionGrid map_of(const BoxWorld& world) {
  return test::rasterize(world, 0.05, {{0, 0}, {600, 80}});
}

enum class Model { kGrid, kField, kPatch };

class Score : public testing::TestWithParam<Model> {
 protected:
  static Localizer localizer(const BoxWorld& world, bool has_search = true) {
    LocalizerConfig config;
    config.global_search.is_used = has_search;
    config.particles = 300;
    config.adaptive = false;
    config.gating.every_scans = 1;
    return Localizer(config, model(map_of(world)), 3);
  }
  static Localizer started(const BoxWorld& world, const Pose2& at) {
    Localizer result = localizer(world);
    result.initialize({at, Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal()});
    return result;
  }

 private:
  static std::shared_ptr<const SensorModel> model(const ReflectionGrid& map) {
    if (GetParam() == Model::kGrid) return make_grid_beam_model(map);
    if (GetParam() == Model::kField) return std::make_shared<LikelihoodFieldModel>(map);
    auto patches = std::make_shared<patch::PatchMap>();
    patches->base = map;
    return std::make_shared<patch_beams::PatchBeamModel>(patches,
                                                         patch_beams::PatchBeamModelConfig{});
  }
};

double part(const Localizer& localizer, ScoreEvidence::Part which) {
  return localizer.score_evidence().part[which];
}

TEST_P(Score, IsNothingBeforeAScanAndMuchAtARightPose) {
  Drive drive({1.5, 2.2, 0.0}, 6);
  Localizer localizer = started(room(), drive.truth());
  Observation blind = drive.look(room());
  std::fill(blind.scan.ranges_m.begin(), blind.scan.ranges_m.end(),
            std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(localizer.update(blind).score, 0.0);
  double score = 0.0;
  for (int n = 0; n < 40; ++n) {
    drive.step({0.05, 0.0, 0.0});
    score = localizer.update(drive.look(room())).score;
  }
  EXPECT_GT(score, 0.9);
}

TEST_P(Score, FallsAtOnceWhenTheRobotIsCarriedAway) {
  Drive drive({1.5, 2.2, 0.0}, 6);
  Localizer localizer = started(room(), drive.truth());
  for (int n = 0; n < 40; ++n) {
    drive.step({0.05, 0.0, 0.0});
    (void)localizer.update(drive.look(room()));
  }
  drive.kidnap({8.5, 1.2, 1.0});
  EXPECT_LT(localizer.update(drive.look(room())).score, 0.9) << "with the first scan";
  double score = 1.0;
  for (int n = 0; n < 9; ++n) score = localizer.update(drive.look(room())).score;
  EXPECT_LT(score, 0.1);
}

TEST_P(Score, SideWallsThatFitAnywhereTellLittle) {
  Drive in_room({1.5, 2.2, 0.0}, 6);
  Drive in_corridor({10.0, 1.2, 0.0}, 6);
  Localizer a = started(room(), in_room.truth());
  Localizer b = started(corridor(), in_corridor.truth());
  double room_score = 0.0;
  LocalizationResult result;
  for (int n = 0; n < 60; ++n) {
    in_room.step({0.05, 0.0, 0.0});
    in_corridor.step({0.05, 0.0, 0.0});
    room_score = a.update(in_room.look(room(), 4.0)).score;
    result = b.update(in_corridor.look(corridor(), 4.0));
  }
  EXPECT_GT(result.health.inlier_share_fast, 0.85) << "as much as in the room";
  EXPECT_LT(part(b, ScoreEvidence::kMarginLong), 0.05);
  EXPECT_GT(part(a, ScoreEvidence::kMarginLong), 0.1);
  EXPECT_LT(result.score, room_score);
}

TEST_P(Score, AnEndWallThatIsNotThereTells) {
  // In the middle of a corridor, and believed to be there, or 3 m before its end.
  const auto score_at = [](const Pose2& believed) {
    Drive drive({14.0, 1.2, 0.0}, 6);
    Localizer localizer = started(corridor(), believed);
    LocalizationResult result;
    for (int n = 0; n < 20; ++n) {
      drive.step({0.02, 0.0, 0.0});
      result = localizer.update(drive.look(corridor(), 6.0));
    }
    EXPECT_GT(result.health.inlier_share_fast, 0.6) << "the side walls fit";
    return result.score;
  };
  const double wrong = score_at({26.5, 1.2, 0.0});
  EXPECT_LT(wrong, score_at({14.0, 1.2, 0.0}) - 0.05);
  // End points alone cannot say that a beam went through a wall.
  if (GetParam() != Model::kField) {
    EXPECT_LT(wrong, 0.5);
  }
}

TEST_P(Score, WearsOffWhileNothingIsSeen) {
  Drive drive({1.5, 2.2, 0.0}, 6);
  Localizer localizer = started(room(), drive.truth());
  double seen = 0.0;
  for (int n = 0; n < 40; ++n) {
    drive.step({0.05, 0.0, 0.0});
    seen = localizer.update(drive.look(room())).score;
  }
  double unseen = seen;
  for (int n = 0; n < 20; ++n) {
    drive.step({0.1, 0.0, 0.0});
    Observation blind = drive.look(room());
    blind.scan.ranges_m.clear();
    unseen = localizer.update(blind).score;
  }
  EXPECT_NEAR(unseen / seen, std::exp(-0.2), 0.02) << "of 2 m";
}

TEST_P(Score, IsLowWhileTheRobotMayBeAnywhere) {
  Drive drive({1.5, 2.2, 0.0}, 6);
  Localizer localizer = Score::localizer(room(), false);
  localizer.initialize_global(map_of(room()));
  const LocalizationResult result = localizer.update(drive.look(room()));
  ASSERT_GT(result.health.position_stddev_m, 0.5);
  EXPECT_LT(result.score, 0.1);
  EXPECT_EQ(part(localizer, ScoreEvidence::kDoubt), 1.0);
}

TEST_P(Score, IsLowWhileSeveralPlacesOfACorridorFit) {
  Drive drive({10.0, 1.2, 0.0}, 6);
  Localizer localizer = Score::localizer(corridor());
  localizer.initialize_global(map_of(corridor()));
  const LocalizationResult result = localizer.update(drive.look(corridor(), 4.0));
  ASSERT_TRUE(result.is_ambiguous);
  EXPECT_LT(result.score, 0.3);
  EXPECT_GT(part(localizer, ScoreEvidence::kDoubt), 0.9);
}

INSTANTIATE_TEST_SUITE_P(Models, Score, testing::Values(Model::kGrid, Model::kField, Model::kPatch),
                         [](const testing::TestParamInfo<Model>& tested) {
                           return std::string(tested.param == Model::kGrid    ? "Grid"
                                              : tested.param == Model::kField ? "Field"
                                                                              : "Patch");
                         });

TEST(ScoreCalibration, MoreBeamsThatFitNeverCountAgainstAPose) {
  for (std::size_t i = 0; i < ScoreEvidence::kParts; ++i) {
    if (i == ScoreEvidence::kStopped || i == ScoreEvidence::kSpread) continue;
    if (i == ScoreEvidence::kDoubt) {
      EXPECT_LT(kScoreWeights[i], 0.0);
    } else {
      EXPECT_GE(kScoreWeights[i], 0.0) << i;
    }
  }
}

TEST(ScoreCalibration, IsAProbability) {
  ScoreEvidence evidence;
  EXPECT_NEAR(calibrated_score(evidence), 1.0 / (1.0 + std::exp(kScoreCaution - kScoreBias)),
              1e-12);
  evidence.part.fill(1e6);
  const double sum = calibrated_score(evidence);
  EXPECT_TRUE(sum == 0.0 || sum == 1.0);
}

TEST(ScoreDoubt, RisesAtOnceAndWearsOffSlowly) {
  double doubt = 0.0;
  for (int n = 0; n < 5; ++n) doubt = next_doubt(doubt, -1.0);
  EXPECT_NEAR(doubt, 1.0, 1e-12);
  EXPECT_EQ(next_doubt(doubt, -1.0), 1.0);
  for (int n = 0; n < 40; ++n) doubt = next_doubt(doubt, 1.0);
  EXPECT_NEAR(doubt, std::exp(-1.0), 1e-9);
}

TEST(ScoreVerdict, APoseThatIsLikelierRightIsNotCalledLost) {
  for (const double score : {0.9, 0.3}) {
    HealthMonitor monitor((RecoveryConfig()));
    for (int n = 0; n < 50; ++n) monitor.add(0.5, {0.95, 1.0}, 0.05, 0.95);
    for (int n = 0; n < 20; ++n) monitor.add(0.5, {0.3, 1.0}, 0.05, score);
    EXPECT_EQ(monitor.health().state == HealthState::kLost, score < 0.5) << score;
  }
}

/// A grid that a run learns from: what it is told of each pose.
class Learner final : public SensorModel {
 public:
  explicit Learner(std::shared_ptr<std::vector<PoseTrust>> told) : told_(std::move(told)) {}
  std::size_t log_likelihoods(const Scan& scan, const Weighing& weighing, ParticleSet& particles,
                              std::span<double> log_likelihood, WorkerPool& pool) const override {
    return grid_->log_likelihoods(scan, weighing, particles, log_likelihood, pool);
  }
  [[nodiscard]] double tempering() const override { return grid_->tempering(); }
  [[nodiscard]] InlierShares inlier_shares(const Scan& scan, const Pose2& map_from_robot,
                                           const ParticleSet& particles) const override {
    return grid_->inlier_shares(scan, map_from_robot, particles);
  }
  [[nodiscard]] std::unique_ptr<SensorModel> for_one_run() const override {
    return std::make_unique<Learner>(told_);
  }
  void learn(const Observation& /*observation*/, const Pose2Gaussian& /*map_from_robot*/,
             const PoseTrust& trust) override {
    told_->push_back(trust);
  }

 private:
  std::shared_ptr<const SensorModel> grid_ = make_grid_beam_model(map_of(room()));
  std::shared_ptr<std::vector<PoseTrust>> told_;
};

TEST(ScoreOfALearner, IsWhatTheRunSaysOfThePose) {
  const Pose2 right{1.5, 2.2, 0.0};
  for (const bool is_right : {true, false}) {
    SCOPED_TRACE(is_right);
    Drive drive(right, 5);
    const auto told = std::make_shared<std::vector<PoseTrust>>();
    Localizer localizer({}, std::make_shared<Learner>(told), 3);
    localizer.initialize(
        {is_right ? right : Pose2{8.5, 1.2, 1.0}, Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal()});
    LocalizationResult result;
    for (int n = 0; n < 40; ++n) {
      drive.step({0.05, 0.0, 0.0});
      result = localizer.update(drive.look(room()));
    }
    ASSERT_FALSE(told->empty());
    EXPECT_EQ(told->back().score, result.score);
    EXPECT_EQ(told->back().score > 0.5, is_right) << told->back().score;
    EXPECT_EQ(told->back().is_in_doubt, result.is_ambiguous || result.health.is_in_doubt);
  }
}

TEST(ScoreOfALearner, IsInDoubtUntilAPlaceThatWasFoundIsConfirmed) {
  for (const double confirmed_score : {0.6, 0.97}) {
    SCOPED_TRACE(confirmed_score);
    LocalizerConfig config;
    config.global_search.is_used = true;
    config.global_search.confirmation.confirmed_score = confirmed_score;
    const auto told = std::make_shared<std::vector<PoseTrust>>();
    Localizer localizer(config, std::make_shared<Learner>(told), 3);
    localizer.initialize_global(map_of(room()));
    Drive drive({1.5, 2.2, 0.0}, 5);
    int pending = 0;
    for (int n = 0; n < 40; ++n) {
      drive.step({0.05, 0.0, 0.0});
      const LocalizationResult result = localizer.update(drive.look(room()));
      pending += result.is_ambiguous && result.places.size() == 1 ? 1 : 0;
      if (!result.weighed) continue;
      EXPECT_EQ(told->back().is_in_doubt, result.is_ambiguous || result.health.is_in_doubt) << n;
    }
    EXPECT_EQ(pending > 0, confirmed_score > 0.9);
    EXPECT_EQ(told->back().is_in_doubt, confirmed_score > 0.9);
  }
}

}  // namespace
}  // namespace strata::localization
