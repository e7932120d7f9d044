// SPDX-License-Identifier: Apache-2.0
/// What all particles together believe of the sub-maps, for whoever asks after a scan.
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/localization/localizer.hpp"
#include "core/localization/patch_states.hpp"
#include "tests/core/localization/box_map.hpp"

namespace strata::localization {
namespace {

using test::box_map;
using test::Drive;
using test::room;

/// Keeps what it is given of the posterior.
class CuriousModel final : public SensorModel {
 public:
  CuriousModel() : states_(box_map(), {}) {}
  mutable std::vector<SubmapBelief> given;

  std::size_t log_likelihoods(const Scan&, const Weighing&, ParticleSet& particles,
                              std::span<double> log_likelihood, WorkerPool&) const override {
    for (std::size_t i = 0; i < particles.size(); ++i) {
      log_likelihood[i] = -particles.pose(i).y;
      particles.belief(i)[0] = static_cast<float>(std::fmod(particles.pose(i).x, 1.0));
    }
    return 1;
  }
  [[nodiscard]] double tempering() const override { return 1.0; }
  [[nodiscard]] InlierShares inlier_shares(const Scan&, const Pose2&,
                                           const ParticleSet&) const override {
    return {0.0, 1.0};
  }
  [[nodiscard]] InlierShares inlier_shares_given(const std::vector<SubmapBelief>& posterior,
                                                 const Scan&, const Pose2&,
                                                 const ParticleSet&) const override {
    given = posterior;
    return {0.0, 1.0};
  }
  [[nodiscard]] const PatchStates* patch_states() const override { return &states_; }

 private:
  PatchStates states_;
};

// It was made twice a scan, and again for scans that are not weighed.
TEST(PooledBeliefs, ThePosteriorOfAScanIsMadeOnceAndIsThatOfItsParticles) {
  const auto model = std::make_shared<CuriousModel>();
  Drive drive({1.5, 2.0, 0.0}, 12);
  LocalizerConfig config;
  config.particles = 300;
  config.adaptive = false;
  Localizer localizer(config, model, 3, 2);
  localizer.initialize({drive.truth(), Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal()});
  int gated = 0;
  for (int n = 0; n < 20; ++n) {
    drive.step({n % 4 == 0 ? 0.3 : 0.0, 0.0, 0.0});
    const LocalizationResult result = localizer.update(drive.look(room()));
    gated += result.weighed ? 0 : 1;
    const auto now = model->patch_states()->posterior(localizer.particles());
    ASSERT_EQ(result.submaps.size(), now.size());
    ASSERT_EQ(model->given.size(), now.size());
    EXPECT_EQ(result.submaps[0].probability, now[0].probability) << n;
    EXPECT_EQ(model->given[0].probability, now[0].probability) << n;
    EXPECT_EQ(result.submaps[0].mass, now[0].mass) << n;
  }
  EXPECT_GT(gated, 0);
}

}  // namespace
}  // namespace strata::localization
