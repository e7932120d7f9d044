// SPDX-License-Identifier: Apache-2.0
/// A localizer that goes on from saved bytes gives what the one that was saved gives, to the bit.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/damage.hpp"
#include "core/base/error.hpp"
#include "core/localization/likelihood_field_model.hpp"
#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "tests/core/localization/box_map.hpp"

namespace strata::localization {
namespace {

using test::BoxWorld;
using test::Drive;

enum class Kind { kGrid, kField, kPerParticle, kShared, kNone };
enum class Start { kPose, kEverywhere, kSearch };

struct Case {
  const char* name;
  Kind kind;
  Start start;
};

std::shared_ptr<const SensorModel> make_model(Kind kind) {
  const ReflectionGrid map = test::rasterize(test::room(), 0.05, test::kRect);
  if (kind == Kind::kGrid) return make_grid_beam_model(map);
  if (kind == Kind::kField) return std::make_shared<LikelihoodFieldModel>(map);
  patch_beams::PatchBeamModelConfig config;
  config.states.memory = kind == Kind::kShared ? PatchMemory::kShared
                         : kind == Kind::kNone ? PatchMemory::kNone
                                               : PatchMemory::kPerParticle;
  return std::make_shared<patch_beams::PatchBeamModel>(test::box_map(), config);
}

LocalizerConfig config_of(Start start) {
  LocalizerConfig config;
  config.particles = 200;
  config.global_start.max_particles = 3000;
  config.global_search.is_used = start == Start::kSearch;
  config.global_search.confirmation.confirmed_score = 0.97;  // not in the first scan
  config.recovery = kidnapping_recovery();
  return config;
}

/// A drive with all that a filter has to go through: gaps in odometry, scans that say nothing, a
/// second scanner, a box that comes, and a robot that is carried away.
std::vector<Observation> eventful_drive() {
  std::vector<Observation> seen;
  Drive drive({3.2, 1.8, 0.0}, 5);
  for (int n = 0; n < 90; ++n) {
    drive.step({0.06, 0.0, n % 30 < 15 ? 0.05 : -0.05});
    if (n == 55) drive.kidnap({8.5, 1.5, 2.0});
    Observation look = drive.look(n < 30 ? test::room() : test::room_with_box());
    if (n % 17 == 5) look.has_odometry = false;
    if (n % 23 == 7) {
      look.scan.ranges_m.assign(look.scan.size(), std::numeric_limits<float>::quiet_NaN());
    }
    if (n > 20 && n % 3 == 0) look.scan.robot_from_laser = {0.0, 0.0, 0.5};
    seen.push_back(look);
  }
  return seen;
}

class SavedState : public testing::TestWithParam<Case> {
 protected:
  Localizer make(int threads = 1) const {
    Localizer localizer(config_of(GetParam().start), make_model(GetParam().kind), 3, threads);
    localizer.set_free_space(test::rasterize(test::room(), 0.05, test::kRect));
    return localizer;
  }
  Localizer started() const {
    Localizer localizer = make();
    if (GetParam().start == Start::kPose) {
      localizer.initialize({{3.2, 1.8, 0.0}, Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal()});
    } else {
      localizer.initialize_global();
    }
    return localizer;
  }
};

void expect_same(const LocalizationResult& a, const LocalizationResult& b) {
  EXPECT_EQ(a.pose.mean, b.pose.mean);
  EXPECT_EQ(a.pose.covariance, b.pose.covariance);
  EXPECT_EQ(a.score, b.score);
  EXPECT_EQ(a.health.state, b.health.state);
  EXPECT_EQ(a.health.likelihood_ratio, b.health.likelihood_ratio);
  EXPECT_EQ(a.particles, b.particles);
  EXPECT_EQ(a.is_ambiguous, b.is_ambiguous);
  ASSERT_EQ(a.submaps.size(), b.submaps.size());
  for (std::size_t i = 0; i < a.submaps.size(); ++i) {
    EXPECT_EQ(a.submaps[i].probability, b.submaps[i].probability);
    EXPECT_EQ(a.submaps[i].mass, b.submaps[i].mass);
  }
}

TEST_P(SavedState, GoesOnToTheSameBitsFromAnyScan) {
  const std::vector<Observation> seen = eventful_drive();
  Localizer robot = started();
  std::vector<Localizer> others;
  for (std::size_t n = 0; n < seen.size(); ++n) {
    if (n < 12 || n % 11 == 0) {  // a search is decided, and confirmed, in the first scans
      const auto state = robot.saved_state();
      ASSERT_TRUE(state.has_value());
      others.push_back(make(2));
      others.back().restore(*state, "test");
      EXPECT_EQ(others.back().saved_state(), state) << "at scan " << n;
    }
    const LocalizationResult expected = robot.update(seen[n]);
    for (Localizer& other : others) {
      SCOPED_TRACE(n);
      expect_same(other.update(seen[n]), expected);
    }
    if (HasFailure()) return;
  }
  for (Localizer& other : others) EXPECT_EQ(other.saved_state(), robot.saved_state());
}

TEST_P(SavedState, ThatIsCutOffOrGoesOnIsRefused) {
  const std::vector<Observation> seen = eventful_drive();
  Localizer robot = started();
  for (std::size_t n = 0; n < 30; ++n) robot.update(seen[n]);
  std::vector<std::uint8_t> state = *robot.saved_state();
  Localizer other = make();
  for (std::size_t size = 0; size < state.size(); size += 1 + state.size() / 97) {
    EXPECT_THROW(other.restore(std::span(state).first(size), "test"), Error) << size;
  }
  state.push_back(0);
  EXPECT_THROW(other.restore(state, "test"), DamageError);
  EXPECT_THROW(other.update(seen[0]), std::logic_error) << "what is damaged is not gone on from";
}

TEST_P(SavedState, ThatIsDamagedIsRefusedOrHarmless) {
  const std::vector<Observation> seen = eventful_drive();
  Localizer robot = started();
  for (std::size_t n = 0; n < 30; ++n) robot.update(seen[n]);
  const std::vector<std::uint8_t> whole = *robot.saved_state();
  for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 61) {
    std::vector<std::uint8_t> state = whole;
    state[at] ^= 0x81;
    Localizer other = make();
    try {
      other.restore(state, "test");
    } catch (const Error&) {
      continue;
    }
    for (std::size_t n = 30; n < 34; ++n) other.update(seen[n]);
  }
}

INSTANTIATE_TEST_SUITE_P(OfEveryModelAndStart, SavedState,
                         testing::Values(Case{"grid", Kind::kGrid, Start::kPose},
                                         Case{"gridEverywhere", Kind::kGrid, Start::kEverywhere},
                                         Case{"gridSearch", Kind::kGrid, Start::kSearch},
                                         Case{"field", Kind::kField, Start::kPose},
                                         Case{"perParticle", Kind::kPerParticle, Start::kPose},
                                         Case{"search", Kind::kPerParticle, Start::kSearch},
                                         Case{"shared", Kind::kShared, Start::kPose},
                                         Case{"paper", Kind::kNone, Start::kEverywhere}),
                         [](const auto& tested) { return tested.param.name; });

TEST(SavedStateOfALocalizer, IsRefusedInOtherMaps) {
  const auto localizer_in = [](Kind kind) {
    return Localizer(config_of(Start::kPose), make_model(kind), 3, 1);
  };
  const Pose2Gaussian start{{3.2, 1.8, 0.0}, Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal()};
  Localizer with = localizer_in(Kind::kPerParticle);
  Localizer without = localizer_in(Kind::kGrid);
  with.initialize(start);
  without.initialize(start);
  EXPECT_THROW(localizer_in(Kind::kGrid).restore(*with.saved_state(), "test"), InputError);
  EXPECT_THROW(localizer_in(Kind::kPerParticle).restore(*without.saved_state(), "test"),
               InputError);
  EXPECT_THROW(localizer_in(Kind::kNone).restore(*with.saved_state(), "test"), InputError);
}

/// Learns while it localizes.
class LearningModel final : public SensorModel {
 public:
  std::size_t log_likelihoods(const Scan& scan, const Weighing&, ParticleSet&, std::span<double>,
                              WorkerPool&) const override {
    return scan.size();
  }
  [[nodiscard]] double tempering() const override { return 1.0; }
  [[nodiscard]] InlierShares inlier_shares(const Scan&, const Pose2&,
                                           const ParticleSet&) const override {
    return {};
  }
  [[nodiscard]] std::unique_ptr<SensorModel> for_one_run() const override {
    return std::make_unique<LearningModel>();
  }
};

TEST(SavedStateOfALocalizer, IsNoneBeforeAStartAndOfAModelThatLearns) {
  Localizer localizer({}, make_model(Kind::kGrid), 1);
  EXPECT_FALSE(localizer.saved_state().has_value());
  Localizer learns({}, std::make_shared<LearningModel>(), 1);
  learns.initialize({});
  EXPECT_FALSE(learns.saved_state().has_value());
}

}  // namespace
}  // namespace strata::localization
