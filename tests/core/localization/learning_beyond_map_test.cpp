// SPDX-License-Identifier: Apache-2.0
// What a model is told of a pose beyond the map, which it may learn from.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "tests/core/localization/box_world.hpp"

namespace strata::localization {
namespace {

/// That knows nothing, and keeps how far it was told to believe the pose.
class Learner final : public SensorModel {
 public:
  explicit Learner(std::vector<PoseTrust>* trusts) : trusts_(trusts) {}
  std::size_t log_likelihoods(const Scan& /*scan*/, const Weighing& /*weighing*/,
                              ParticleSet& /*particles*/, std::span<double> log_likelihood,
                              WorkerPool& /*pool*/) const override {
    std::fill(log_likelihood.begin(), log_likelihood.end(), -1.0);
    return 1;
  }
  [[nodiscard]] double tempering() const override { return 1.0; }
  [[nodiscard]] InlierShares inlier_shares(const Scan& /*scan*/, const Pose2& /*map_from_robot*/,
                                           const ParticleSet& /*particles*/) const override {
    return {1.0, 1.0};
  }
  void find_unjudged(const Scan& scan, const Pose2& /*map_from_robot*/,
                     std::vector<std::uint8_t>& is_unjudged) const override {
    is_unjudged.assign(scan.size(), 1);
  }
  [[nodiscard]] std::unique_ptr<SensorModel> for_one_run() const override {
    return std::make_unique<Learner>(trusts_);
  }
  void learn(const Observation& /*observation*/, const Pose2Gaussian& /*map_from_robot*/,
             const PoseTrust& trust) override {
    trusts_->push_back(trust);
  }

 private:
  std::vector<PoseTrust>* trusts_;
};

TEST(LearningBeyondTheMap, IsToldThatThePoseIsInDoubt) {
  for (const bool is_used : {true, false}) {
    std::vector<PoseTrust> trusts;
    LocalizerConfig config;
    config.beyond_map.is_used = is_used;
    Localizer localizer(config, std::make_shared<Learner>(&trusts), 5);
    test::Drive drive({1.0, 1.0, 0.0}, 4);
    localizer.initialize({drive.truth(), Eigen::Vector3d(1e-3, 1e-3, 1e-3).asDiagonal()});
    localizer.update(drive.look({{0.0, 3.0, 5.0, 3.3}}));
    ASSERT_EQ(trusts.size(), 1U);
    EXPECT_EQ(trusts.back().is_in_doubt, is_used);
  }
}

}  // namespace
}  // namespace strata::localization
