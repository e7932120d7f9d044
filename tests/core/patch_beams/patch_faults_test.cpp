// SPDX-License-Identifier: Apache-2.0
// What a localizer with a patch map meets in bad hours: odd maps, odd odometry, a new map mid-run.
#include <cmath>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "core/rays/ray_caster.hpp"
#include "tests/core/localization/box_map.hpp"

namespace strata::patch_beams {
namespace {

using localization::InlierShares;
using localization::LocalizationResult;
using localization::Localizer;
using localization::LocalizerConfig;
using localization::ParticleSet;
using localization::PatchMemory;
using localization::PatchStates;
using localization::PatchStatesConfig;
using localization::RangeProviderModel;
using localization::SensorModel;
using localization::Weighing;

using test::box_map;
using test::BoxWorld;
using test::Drive;
using test::empty_map;
using test::room;
using test::room_with_box;
using test::submap_of;

std::shared_ptr<const SensorModel> model_of(std::shared_ptr<patch::PatchMap> map,
                                            PatchMemory memory = PatchMemory::kPerParticle) {
  PatchBeamModelConfig config;
  config.states.memory = memory;
  return std::make_shared<PatchBeamModel>(std::move(map), config);
}

Localizer started(const std::shared_ptr<const SensorModel>& model, const Drive& drive) {
  LocalizerConfig config;
  config.particles = 300;
  config.adaptive = false;
  Localizer localizer(config, model, 3, 2);
  localizer.initialize({drive.truth(), Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal()});
  return localizer;
}

double error_m(const LocalizationResult& result, const Drive& drive) {
  return (result.pose.mean.translation() - drive.truth().translation()).norm();
}

TEST(PatchFaults, AMapWithoutSubmapsWeighsAsTheGridMapDoes) {
  const auto map = empty_map();
  const auto patches = model_of(map);
  const RangeProviderModel<rays::RayCaster> grid(
      std::make_shared<const rays::RayCaster>(map->base));
  Drive drive({1.5, 2.0, 0.0}, 4);
  const Observation observation = drive.look(room());
  ParticleSet particles;
  particles.resize(50);
  for (std::size_t i = 0; i < 50; ++i)
    particles.set_pose(i, {1.0 + 0.02 * static_cast<double>(i), 2.0, 0.0});
  patches->patch_states()->prepare(particles);
  WorkerPool pool(1);
  std::vector<double> a(50);
  std::vector<double> b(50);
  EXPECT_EQ(patches->log_likelihoods(observation.scan, {2.0}, particles, a, pool),
            grid.log_likelihoods(observation.scan, {2.0}, particles, b, pool));
  for (std::size_t i = 0; i < 50; ++i) EXPECT_NEAR(a[i], b[i], 1e-9);
  Localizer localizer = started(patches, drive);
  LocalizationResult result;
  for (int n = 0; n < 30; ++n) {
    drive.step({0.1, 0.0, 0.0});
    result = localizer.update(drive.look(room()));
  }
  EXPECT_LT(error_m(result, drive), 0.15);
  EXPECT_TRUE(result.submaps.empty());
}

TEST(PatchFaults, AThousandSubmapsLocalizeToo) {
  auto map = empty_map();
  for (int i = 0; i < 1000; ++i) {
    const int x = 4 * (i % 50);
    const int y = 4 * (i / 50);
    map->submaps.push_back(submap_of(i, {{x, y}, {x + 4, y + 4}}, {room(), room_with_box()}));
  }
  for (const PatchMemory memory :
       {PatchMemory::kNone, PatchMemory::kShared, PatchMemory::kPerParticle}) {
    Drive drive({1.5, 2.0, 0.0}, 5);
    Localizer localizer = started(model_of(map, memory), drive);
    LocalizationResult result;
    for (int n = 0; n < 5; ++n) {
      drive.step({0.1, 0.0, 0.0});
      result = localizer.update(drive.look(room()));
    }
    EXPECT_EQ(result.submaps.size(), 1000U);
    EXPECT_LT(error_m(result, drive), 0.2) << enum_name(memory);
  }
}

TEST(PatchFaults, ScansBeforeAnyOdometryKeepThePose) {
  Drive drive({1.5, 2.0, 0.0}, 6);
  Localizer localizer = started(model_of(box_map()), drive);
  LocalizationResult result;
  for (int n = 0; n < 20; ++n) {
    Observation observation = drive.look(room());
    observation.has_odometry = n >= 10;
    if (n < 10) observation.odom_from_robot = Pose2{};
    result = localizer.update(observation);
  }
  EXPECT_LT(error_m(result, drive), 0.15);
  EXPECT_EQ(localizer.odometry_jumps(), 0U);
}

TEST(PatchFaults, OdometryThatJumpsIsLeftOutAndCounted) {
  Drive drive({1.5, 2.0, 0.0}, 7);
  Localizer localizer = started(model_of(box_map()), drive);
  LocalizationResult result;
  for (int n = 0; n < 40; ++n) {
    drive.step({0.1, 0.0, 0.0});
    Observation observation = drive.look(room());
    // The base was restarted: its odometry begins anew, far from where it was.
    if (n >= 20)
      observation.odom_from_robot = Pose2{-40.0, 25.0, 1.0} * observation.odom_from_robot;
    result = localizer.update(observation);
    EXPECT_LT(error_m(result, drive), 0.3) << n;
  }
  EXPECT_EQ(localizer.odometry_jumps(), 1U);
}

/// Says that no particle can have seen anything.
class ImpossibleModel final : public SensorModel {
 public:
  std::size_t log_likelihoods(const Scan&, const Weighing&, ParticleSet&,
                              std::span<double> log_likelihood, WorkerPool&) const override {
    std::fill(log_likelihood.begin(), log_likelihood.end(),
              -std::numeric_limits<double>::infinity());
    return 1;
  }
  [[nodiscard]] double tempering() const override { return 1.0; }
  [[nodiscard]] InlierShares inlier_shares(const Scan&, const Pose2&,
                                           const ParticleSet&) const override {
    return {0.0, 1.0};
  }
};

TEST(PatchFaults, ZeroLikelihoodEverywhereKeepsTheParticles) {
  Drive drive({1.5, 2.0, 0.0}, 8);
  Localizer localizer = started(std::make_shared<ImpossibleModel>(), drive);
  LocalizationResult result;
  for (int n = 0; n < 10; ++n) {
    drive.step({0.1, 0.0, 0.0});
    result = localizer.update(drive.look(room()));
  }
  EXPECT_LT(error_m(result, drive), 0.3) << "odometry alone goes on";
  double sum = 0.0;
  for (const double w : localizer.particles().weight) sum += w;
  EXPECT_NEAR(sum, 1.0, 1e-9);
}

TEST(PatchFaults, ANewMapMidRunKeepsThePoseAndWhatIsBelieved) {
  for (const PatchMemory memory :
       {PatchMemory::kNone, PatchMemory::kShared, PatchMemory::kPerParticle}) {
    Drive drive({1.5, 2.0, 0.0}, 9);
    Localizer localizer = started(model_of(box_map(), memory), drive);
    LocalizationResult before;
    for (int n = 0; n < 30; ++n) {
      drive.step({0.1, 0.0, 0.0});
      before = localizer.update(drive.look(room_with_box()));
    }
    // The same sub-map, a little larger, with a third configuration; and another sub-map.
    auto next = empty_map();
    next->submaps.push_back(submap_of(0, {{140, 40}, {160, 80}}, {room(), room()}));
    BoxWorld third = room();
    third.push_back({4.5, 1.5, 5.1, 2.1});
    next->submaps.push_back(submap_of(1, {{79, 0}, {113, 41}}, {room(), room_with_box(), third}));
    const std::vector<double> x = localizer.particles().x_m;
    localizer.set_model(model_of(next, memory));
    EXPECT_EQ(localizer.particles().x_m, x);
    LocalizationResult result;
    for (int n = 0; n < 5; ++n) {
      drive.step({0.05, 0.0, 0.0});
      result = localizer.update(drive.look(room_with_box()));
      EXPECT_LT(error_m(result, drive), 0.2);
    }
    ASSERT_EQ(result.submaps.size(), 2U);
    EXPECT_GT(before.submaps[0].probability[1], 0.6) << enum_name(memory);
    EXPECT_GT(result.submaps[1].probability[1], 0.5) << enum_name(memory);
  }
}

// An online learner orders, merges and forgets configurations as it likes; what was believed goes
// with what they look like, not with their place in the list.
TEST(PatchFaults, ANewMapLeavesAParticleTheSubmapWhoseConfigurationItHolds) {
  const auto map = empty_map();
  map->submaps.push_back(submap_of(0, {{79, 0}, {113, 41}}, {room(), room_with_box()}));
  map->submaps.push_back(submap_of(1, {{140, 0}, {160, 41}}, {room(), room()}));
  PatchStatesConfig config;
  config.memory = PatchMemory::kNone;
  const PatchStates states(map, config);
  ParticleSet particles;
  particles.resize(20);
  states.prepare(particles);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    particles.set_pose(i, {6.4, 1.0, 0.0});  // 0.75 m beside its own, 0.6 m beside the other
    particles.submap[i] = 0;
    particles.configuration[i] = 1;
  }
  states.adopt(&states, 1, 5, particles);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    EXPECT_EQ(particles.submap[i], 0) << i;
    EXPECT_EQ(particles.configuration[i], 1) << i;
  }
}

TEST(PatchFaults, BeliefFollowsWhatConfigurationsLookLike) {
  BoxWorld third = room();
  third.push_back({4.5, 1.5, 5.1, 2.1});
  const CellRect rect{{80, 0}, {112, 60}};
  auto first = empty_map();
  first->submaps.push_back(submap_of(0, rect, {room(), room_with_box(), third}));
  auto turned = empty_map();
  turned->submaps.push_back(submap_of(0, rect, {third, room_with_box(), room()}));
  auto forgot = empty_map();
  forgot->submaps.push_back(submap_of(0, rect, {room_with_box(), room()}));
  auto split = empty_map();
  split->submaps.push_back(submap_of(0, rect, {room(), room_with_box(), room_with_box(), third}));
  PatchStatesConfig config;
  for (const PatchMemory memory : {PatchMemory::kPerParticle, PatchMemory::kShared}) {
    config.memory = memory;
    const PatchStates before(first, config);
    ParticleSet particles;
    particles.resize(3);
    before.prepare(particles);
    const std::vector<float> belief{0.1F, 0.7F, 0.2F};
    for (std::size_t i = 0; i < particles.size(); ++i) {
      std::copy(belief.begin(), belief.end(), particles.belief(i).begin());
    }
    if (memory == PatchMemory::kShared) particles.shared_belief = belief;
    const auto adopted = [&](const std::shared_ptr<patch::PatchMap>& map) {
      ParticleSet copy = particles;
      PatchStates(map, config).adopt(&before, 1, 5, copy);
      if (memory == PatchMemory::kShared) return copy.shared_belief;
      return std::vector<float>(copy.belief(1).begin(), copy.belief(1).end());
    };
    const auto expect = [&](const std::vector<float>& got, const std::vector<float>& wanted) {
      ASSERT_EQ(got.size(), wanted.size());
      for (std::size_t k = 0; k < got.size(); ++k) EXPECT_NEAR(got[k], wanted[k], 1e-6F) << k;
    };
    expect(adopted(turned), {0.2F, 0.7F, 0.1F});
    // Both have boxes, yet an empty place is what a box elsewhere looks most like.
    const std::vector<float> after = adopted(forgot);
    EXPECT_NEAR(after[0] + after[1], 1.0F, 1e-6F);
    EXPECT_GE(after[0], 0.7F - 1e-6F);
    expect(adopted(split), {0.1F, 0.35F, 0.35F, 0.2F});
  }
}

TEST(PatchFaults, ASubmapThatGrewKeepsWhatWasBelieved) {
  auto small = empty_map();
  small->submaps.push_back(submap_of(0, {{86, 0}, {106, 22}}, {room(), room_with_box()}));
  auto large = empty_map();
  large->submaps.push_back(submap_of(0, {{70, 0}, {130, 60}}, {room_with_box(), room()}));
  PatchStatesConfig config;
  config.memory = PatchMemory::kPerParticle;
  const PatchStates before(small, config);
  ParticleSet particles;
  particles.resize(1);
  before.prepare(particles);
  particles.belief(0)[0] = 0.9F;
  particles.belief(0)[1] = 0.1F;
  PatchStates(large, config).adopt(&before, 1, 5, particles);
  EXPECT_NEAR(particles.belief(0)[1], 0.9F, 1e-6F);
}

TEST(PatchFaults, FromAndToAMapWithoutSubmapsMidRun) {
  Drive drive({1.5, 2.0, 0.0}, 10);
  Localizer localizer = started(model_of(box_map()), drive);
  const auto grid = std::make_shared<const RangeProviderModel<rays::RayCaster>>(
      std::make_shared<const rays::RayCaster>(empty_map()->base));
  LocalizationResult result;
  for (int n = 0; n < 30; ++n) {
    if (n == 10) localizer.set_model(grid);
    if (n == 20) localizer.set_model(model_of(box_map()));
    drive.step({0.1, 0.0, 0.0});
    result = localizer.update(drive.look(room()));
    EXPECT_EQ(result.submaps.size(), n >= 10 && n < 20 ? 0U : 1U);
  }
  EXPECT_LT(error_m(result, drive), 0.15);
}

}  // namespace
}  // namespace strata::patch_beams
