// SPDX-License-Identifier: Apache-2.0
// The patch beam model, which follows beams of many particles at once, against a reference that
// follows one beam after the other with PatchRayCaster::events and mix_events.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/localization/patch_beam_model.hpp"
#include "core/random/stream.hpp"
#include "tests/support/every_target.hpp"

namespace strata::localization {
namespace {

constexpr double kTempering = 2.0;
constexpr double kNothing = std::numeric_limits<double>::infinity();

/// Sub-maps of random content, sparse enough that many beams meet only one of their obstacles.
std::shared_ptr<const patch::PatchMap> random_map(RandomStream& random, bool overlap,
                                                  std::size_t most_configurations) {
  auto map = std::make_shared<patch::PatchMap>();
  map->base = ReflectionGrid(0.1, {{-5, -3}, {60, 24}}, 0.0F);
  for (float& m : map->base.values()) m = random.bernoulli(0.01) ? 0.9F : 0.0F;
  const int starts[] = {8, overlap ? 14 : 22, 36};
  for (int s = 0; s < 3; ++s) {
    patch::Submap submap;
    submap.id = s;
    submap.rect = {{starts[s], 2}, {starts[s] + 10, 18}};
    const std::size_t count = 1 + random.below(static_cast<std::uint32_t>(most_configurations));
    const double density = random.uniform(0.0, 0.04);
    for (std::size_t k = 0; k < count; ++k) {
      patch::Configuration configuration;
      configuration.reflection = ReflectionGrid(0.1, submap.rect, 0.0F);
      for (float& m : configuration.reflection.values())
        m = random.bernoulli(density) ? 0.9F : 0.0F;
      submap.configurations.push_back(configuration);
    }
    map->submaps.push_back(submap);
  }
  return map;
}

Scan random_scan(RandomStream& random) {
  Scan scan;
  scan.angle_min_rad = -3.0;
  scan.angle_increment_rad = 0.15;
  scan.range_max_m = 4.0F;
  scan.robot_from_laser = {0.1, 0.05, 0.2};
  for (int i = 0; i < 41; ++i) {
    scan.ranges_m.push_back(random.bernoulli(0.2) ? std::numeric_limits<float>::infinity()
                                                  : static_cast<float>(random.uniform(0.05, 3.9)));
  }
  return scan;
}

ParticleSet random_particles(const PatchStates& states, RandomStream& random, std::size_t count) {
  ParticleSet particles;
  particles.resize(count);
  states.prepare(particles);
  for (std::size_t i = 0; i < count; ++i) {
    particles.set_pose(
        i, {random.uniform(-1.0, 7.0), random.uniform(-0.5, 2.5), random.uniform(-3.1, 3.1)});
    states.draw(particles, i, random);
  }
  const auto make_random = [&](std::span<float> row) {
    for (std::size_t s = 0; s < states.map().submaps.size(); ++s) {
      const auto part = row.subspan(states.offset(s), static_cast<std::size_t>(states.count(s)));
      std::vector<double> factor;
      for (std::size_t k = 0; k < part.size(); ++k) factor.push_back(random.uniform(0.05, 1.0));
      update_belief(part, factor, 0.0);
    }
  };
  if (states.memory() == PatchMemory::kShared) make_random(particles.shared_belief);
  if (states.memory() == PatchMemory::kPerParticle) {
    for (std::size_t i = 0; i < count; ++i) make_random(particles.belief(i));
  }
  set_uniform_weights(particles);
  return particles;
}

/// What SPEC C4 and C5 say of particle i, beam by beam.
struct Slow {
  double log_likelihood = 0.0;
  std::vector<double> row;  ///< what is to be found in the particle's row
};

class Reference {
 public:
  Reference(const patch::PatchMap& map, const PatchStates& states, const Scan& scan)
      : states_(states),
        caster_(map),
        beams_(select_beams(scan, {})),
        mixture_(BeamMixtureConfig{}, beams_.r_max_m) {}

  Slow weigh(const ParticleSet& particles, std::size_t i) const {
    const bool is_sampled = states_.memory() == PatchMemory::kNone;
    const std::span<const float> belief = is_sampled ? states_.uniform()
                                          : states_.memory() == PatchMemory::kShared
                                              ? std::span<const float>(particles.shared_belief)
                                              : particles.belief(i);
    Slow result;
    std::vector<double> ratio(states_.columns(), 0.0);
    for (std::size_t beam = 0; beam < beams_.size(); ++beam) {
      find(particles, i, beam);
      const auto mix = [&](int s, int k) {
        return std::log(mix_events(events_, values_, end_, states_, belief, s, k));
      };
      const double log_p = is_sampled ? mix(particles.submap[i], particles.patch[i]) : mix(-1, -1);
      result.log_likelihood += log_p / kTempering;
      for (std::size_t s = 0; s < states_.map().submaps.size() && !is_sampled; ++s) {
        for (int k = 0; k < states_.count(s); ++k) {
          ratio[states_.offset(s) + static_cast<std::size_t>(k)] +=
              (mix(static_cast<int>(s), k) - log_p) / kTempering;
        }
      }
    }
    if (!is_sampled) add_memory(particles.submap[i], belief, ratio, result);
    return result;
  }

 private:
  void find(const ParticleSet& particles, std::size_t i, std::size_t beam) const {
    const Pose2 laser = particles.pose(i) * beams_.robot_from_laser;
    const double c =
        std::cos(laser.theta) * beams_.cosine[beam] - std::sin(laser.theta) * beams_.sine[beam];
    const double s =
        std::sin(laser.theta) * beams_.cosine[beam] + std::cos(laser.theta) * beams_.sine[beam];
    caster_.events(laser.x, laser.y, c, s, beams_.r_max_m, particles.submap[i], events_);
    const bool is_hit = beams_.is_hit[beam] != 0;
    values_.clear();
    for (const RayEvent& event : events_) {
      values_.push_back(mixture_.likelihood(is_hit, beams_.range_m[beam], event.range_m));
    }
    end_ = mixture_.likelihood(is_hit, beams_.range_m[beam], kNothing);
  }
  void add_memory(int current, std::span<const float> belief, const std::vector<double>& ratio,
                  Slow& result) const {
    double own = 0.0;
    if (current >= 0) {
      double sum = 0.0;
      const std::size_t offset = states_.offset(static_cast<std::size_t>(current));
      const auto count = static_cast<std::size_t>(states_.count(static_cast<std::size_t>(current)));
      for (std::size_t k = 0; k < count; ++k) {
        sum += static_cast<double>(belief[offset + k]) * std::exp(ratio[offset + k]);
      }
      own = std::log(sum);
    }
    result.log_likelihood += own;
    for (std::size_t s = 0; s < states_.map().submaps.size(); ++s) {
      double sum = 0.0;
      std::vector<double> posterior;
      for (int k = 0; k < states_.count(s); ++k) {
        const std::size_t column = states_.offset(s) + static_cast<std::size_t>(k);
        const bool is_own = static_cast<int>(s) == current;
        const double factor = std::exp(ratio[column] - (is_own ? own : 0.0));
        const bool is_shared = states_.memory() == PatchMemory::kShared;
        posterior.push_back(is_shared ? factor : factor * static_cast<double>(belief[column]));
        sum += is_shared ? 0.0 : posterior.back();
      }
      for (const double p : posterior) result.row.push_back(sum > 0.0 ? p / sum : p);
    }
  }

  const PatchStates& states_;
  PatchRayCaster caster_;
  ScanBeams beams_;
  BeamMixture mixture_;
  mutable std::vector<RayEvent> events_;
  mutable std::vector<double> values_;
  mutable double end_ = 0.0;
};

class PatchBeams : public ::testing::TestWithParam<PatchMemory> {};

TEST_P(PatchBeams, WeighAsTheReferenceDoesBeamByBeam) {
  RandomStream random(31, StreamId::kTest);
  int changed = 0;
  for (int round = 0; round < 24; ++round) {
    const auto map = random_map(random, round % 2 == 0, round % 3 == 0 ? 4 : 2);
    PatchBeamModelConfig config;
    config.states.memory = GetParam();
    config.states.least_belief = 0.0;
    const PatchBeamModel model(map, config);
    const PatchStates& states = *model.patch_states();
    const Scan scan = random_scan(random);
    ParticleSet particles = random_particles(states, random, 90);
    const ParticleSet before = particles;
    std::vector<double> got(particles.size());
    WorkerPool pool(1);
    model.log_likelihoods(scan, kTempering, particles, got, pool);
    const Reference reference(*map, states, scan);
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const Slow expected = reference.weigh(before, i);
      ASSERT_NEAR(got[i], expected.log_likelihood, 1e-5) << round << " " << i;
      for (std::size_t c = 0; c < expected.row.size(); ++c) {
        const auto belief = static_cast<double>(particles.belief(i)[c]);
        ASSERT_NEAR(belief, expected.row[c], 2e-6 + 1e-5 * expected.row[c]) << round << " " << i;
        changed += particles.belief(i)[c] != before.belief(i)[c] ? 1 : 0;
      }
    }
  }
  if (GetParam() != PatchMemory::kNone) {
    EXPECT_GT(changed, 1000);
  }
}

TEST_P(PatchBeams, GiveTheSameBitsOnEveryTargetAndAnyNumberOfThreads) {
  RandomStream random(32, StreamId::kTest);
  for (int round = 0; round < 4; ++round) {
    const auto map = random_map(random, round % 2 == 0, 3);
    PatchBeamModelConfig config;
    config.states.memory = GetParam();
    const PatchBeamModel model(map, config);
    const Scan scan = random_scan(random);
    const ParticleSet before = random_particles(*model.patch_states(), random, 333);
    std::vector<double> first;
    std::vector<float> first_beliefs;
    const auto weigh = [&](int threads) {
      ParticleSet particles = before;
      std::vector<double> got(particles.size());
      WorkerPool pool(threads);
      model.log_likelihoods(scan, kTempering, particles, got, pool);
      if (first.empty()) {
        first = got;
        first_beliefs = particles.beliefs;
      }
      ASSERT_EQ(got, first);
      ASSERT_EQ(particles.beliefs, first_beliefs);
    };
    for (const int threads : {1, 2, 8}) weigh(threads);
    test::for_every_target([&] { weigh(1); });
  }
}

INSTANTIATE_TEST_SUITE_P(EveryMemory, PatchBeams,
                         ::testing::Values(PatchMemory::kNone, PatchMemory::kShared,
                                           PatchMemory::kPerParticle));

TEST(RayBoxes, HoldTheOwnersOfAllThatRaysMeetInThem) {
  RandomStream random(34, StreamId::kTest);
  int met = 0;
  int without = 0;
  for (int round = 0; round < 40; ++round) {
    const auto map = random_map(random, round % 2 == 0, round % 3 == 0 ? 4 : 2);
    const PatchRayCaster caster(*map);
    std::vector<RayEvent> events;
    for (int n = 0; n < 200; ++n) {
      const int current = static_cast<int>(random.below(4)) - 1;
      const double x = random.uniform(-0.5, 6.0);
      const double y = random.uniform(-0.3, 2.4);
      const double angle = random.uniform(-3.1, 3.1);
      caster.events(x, y, std::cos(angle), std::sin(angle), 5.0, current, events);
      for (const RayEvent& event : events) {
        if (event.submap < 0) continue;
        const double at_x = x + event.range_m * std::cos(angle);
        const double at_y = y + event.range_m * std::sin(angle);
        std::uint64_t held = 0;
        for (const RayBox& whole : caster.boxes()) {
          const RayBox& box = caster.seen(whole, current);
          if (at_x < box.min_x_m || at_x > box.max_x_m || at_y < box.min_y_m || at_y > box.max_y_m)
            continue;
          for (const CellOwner& owner : caster.owners_in(box, current)) {
            if (owner.submap == event.submap) held |= owner.mask;
          }
        }
        ASSERT_EQ(held & event.mask, event.mask) << round << ' ' << n;
        ++met;
      }
    }
    for (const RayBox& box : caster.boxes()) {
      for (int s = 0; s < 3; ++s) without += caster.may_end_beams(box, s, 0) ? 0 : 1;
    }
  }
  EXPECT_GT(met, 500);
  EXPECT_GT(without, 10);  // there are boxes in which the known configuration has nothing
}

TEST(RayBoxes, AreThoseThatStepsAlongTheRayFallInto) {
  RandomStream random(33, StreamId::kTest);
  int crossed = 0;
  for (int round = 0; round < 200; ++round) {
    std::vector<RayBox> boxes;
    for (int b = 0; b < 3; ++b) {
      const double x = random.uniform(-4.0, 4.0);
      const double y = random.uniform(-4.0, 4.0);
      boxes.push_back({x, y, x + random.uniform(0.1, 2.0), y + random.uniform(0.1, 2.0)});
    }
    std::vector<double> cosine{1.0, 0.0, -1.0, 0.0};
    std::vector<double> sine{0.0, 1.0, 0.0, -1.0};
    std::vector<double> end;
    for (int k = 0; k < 9; ++k) {
      const double angle = random.uniform(-3.1, 3.1);
      cosine.push_back(std::cos(angle));
      sine.push_back(std::sin(angle));
    }
    for (std::size_t k = 0; k < cosine.size(); ++k) {
      end.push_back(k % 3 == 0 ? kNothing : random.uniform(0.0, 6.0));
    }
    const double x0 = random.uniform(-3.0, 3.0);
    const double y0 = random.uniform(-3.0, 3.0);
    const RayFan fan{x0, y0, 1.0, 0.0, cosine.data(), sine.data(), cosine.size(), 5.0};
    std::vector<RayBox> relative;
    for (const RayBox& box : boxes) {
      relative.push_back({box.min_x_m - x0, box.min_y_m - y0, box.max_x_m - x0, box.max_y_m - y0});
      const double dx = std::max({relative.back().min_x_m, -relative.back().max_x_m, 0.0});
      const double dy = std::max({relative.back().min_y_m, -relative.back().max_y_m, 0.0});
      relative.back().near_m = std::hypot(dx, dy);
    }
    const std::size_t room = fan.count + RayCrossings::kSlack;
    std::vector<double> ray(room), c(room), s(room), from(room), to(room), which(room);
    const std::size_t found =
        cross_boxes(fan, end.data(), relative.data(), relative.size(),
                    {ray.data(), c.data(), s.data(), from.data(), to.data(), which.data()});
    std::size_t place = 0;
    for (std::size_t k = 0; k < fan.count; ++k) {
      const bool is_found = place < found && ray[place] == static_cast<double>(k);
      const double limit = std::min(end[k], fan.max_range_m);
      double first = kNothing;
      double last = -1.0;
      std::uint64_t inside = 0;  // boxes
      for (double t = 0.0; t < limit; t += 0.002) {
        const double x = fan.x_m + t * cosine[k];
        const double y = fan.y_m + t * sine[k];
        for (std::size_t b = 0; b < boxes.size(); ++b) {
          const RayBox& box = boxes[b];
          if (x <= box.min_x_m || x >= box.max_x_m || y <= box.min_y_m || y >= box.max_y_m)
            continue;
          inside |= std::uint64_t{1} << b;
          first = std::min(first, t);
          last = t;
        }
      }
      if (last >= 0.0) {
        ASSERT_TRUE(is_found);
        EXPECT_NEAR(from[place], first, 0.0021);
        EXPECT_NEAR(to[place], last, 0.0021);
        EXPECT_EQ(static_cast<std::uint64_t>(which[place]) & inside, inside);
        EXPECT_LT(which[place], 8.0);
        EXPECT_EQ(c[place], cosine[k]);
        EXPECT_EQ(s[place], sine[k]);
        ++crossed;
      } else if (is_found) {
        EXPECT_LT(to[place] - from[place], 0.0021);  // a corner between two steps
      }
      place += is_found ? 1 : 0;
    }
    EXPECT_EQ(place, found);
  }
  EXPECT_GT(crossed, 200);
}

}  // namespace
}  // namespace strata::localization
