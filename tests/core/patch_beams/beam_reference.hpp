// SPDX-License-Identifier: Apache-2.0
/// Random patch maps, beam by beam: docs/theory/patch_localization.md, "Memory of sub-maps".
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "core/patch_beams/event_mixture.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "core/random/stream.hpp"

namespace strata::patch_beams::test_reference {

inline constexpr double kTempering = 2.0;
inline constexpr double kNothing = std::numeric_limits<double>::infinity();

/// Sub-maps of random content, sparse enough that many beams meet only one of their obstacles. Of
/// an alike one the last configuration has obstacles and the others none.
inline std::shared_ptr<const patch::PatchMap> random_map(RandomStream& random, bool overlap,
                                                         std::size_t max_configurations,
                                                         bool is_alike = false) {
  auto map = std::make_shared<patch::PatchMap>();
  map->base = ReflectionGrid(0.1, {{-5, -3}, {60, 24}}, 0.0F);
  for (float& m : map->base.values()) m = random.bernoulli(0.01) ? 0.9F : 0.0F;
  const int starts[] = {8, overlap ? 14 : 22, 36};
  for (int s = 0; s < 3; ++s) {
    patch::Submap submap;
    submap.id = s;
    submap.rect = {{starts[s], 2}, {starts[s] + 10, 18}};
    const std::size_t count = 1 + random.below(static_cast<std::uint32_t>(max_configurations));
    const double density = random.uniform(0.0, 0.04);
    for (std::size_t k = 0; k < count; ++k) {
      patch::Configuration configuration;
      configuration.reflection = ReflectionGrid(0.1, submap.rect, 0.0F);
      const double share = is_alike && k + 1 < count ? 0.0 : density;
      for (float& m : configuration.reflection.values()) m = random.bernoulli(share) ? 0.9F : 0.0F;
      submap.configurations.push_back(configuration);
    }
    map->submaps.push_back(submap);
  }
  return map;
}

inline Scan random_scan(RandomStream& random) {
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

inline localization::ParticleSet random_particles(const localization::PatchStates& states,
                                                  RandomStream& random, std::size_t count) {
  localization::ParticleSet particles;
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
      localization::update_belief(part, factor, 0.0);
    }
  };
  if (states.memory() == localization::PatchMemory::kShared) make_random(particles.shared_belief);
  if (states.memory() == localization::PatchMemory::kPerParticle) {
    for (std::size_t i = 0; i < count; ++i) make_random(particles.belief(i));
  }
  set_uniform_weights(particles);
  return particles;
}

/// What "Beams through sub-maps" and "Memory of sub-maps" say of particle i, beam by beam.
struct Slow {
  double log_likelihood = 0.0;
  std::vector<double> row;  ///< what is to be found in the particle's row
};

class Reference {
 public:
  Reference(const patch::PatchMap& map, const localization::PatchStates& states, const Scan& scan)
      : states_(states),
        caster_(map),
        beams_(rays::select_beams(scan, {})),
        mixture_(rays::BeamMixtureConfig{}, beams_.r_max_m) {}

  /// From the pose of particle i, in the sub-map that has it; with the beliefs of all.
  localization::InlierShares inlier_shares(const localization::ParticleSet& particles,
                                           std::size_t i) const {
    std::vector<float> belief;
    for (const localization::SubmapBelief& submap : states_.posterior(particles)) {
      for (const double p : submap.probability) belief.push_back(static_cast<float>(p));
    }
    const Pose2 laser = particles.pose(i) * beams_.robot_from_laser;
    localization::ParticleSet one = particles;
    one.submap[i] = states_.submap_of(particles.pose(i).translation());
    localization::InlierShares sum;
    for (std::size_t beam = 0; beam < beams_.size(); ++beam) {
      find(one, i, beam);
      const bool is_hit = beams_.is_hit[beam] != 0;
      const double range_m = beams_.range_m[beam];
      const auto share = [&](auto&& counts) {
        std::vector<double> values;
        for (const RayEvent& event : events_) values.push_back(counts(event.range_m) ? 1.0 : 0.0);
        return mix_events(events_, values, counts(kNothing) ? 1.0 : 0.0, states_, belief);
      };
      const auto is_inlier = [&](double expected_m) {
        return (is_hit || caster_.knows(laser.translation())) &&
               mixture_.is_inlier(is_hit, range_m, expected_m);
      };
      sum.inlier += share(is_inlier) / static_cast<double>(beams_.size());
      const bool is_known = localization::knows_end(
          caster_, laser.translation(), beams_.end_m(laser, beam), mixture_.tolerance_m());
      sum.judged += (is_known ? 1.0 : share([&](double expected_m) {
                      return is_inlier(expected_m) || expected_m < range_m;
                    })) /
                    static_cast<double>(beams_.size());
    }
    return sum;
  }

  Slow weigh(const localization::ParticleSet& particles, std::size_t i) const {
    const bool is_sampled = states_.memory() == localization::PatchMemory::kNone;
    const std::span<const float> belief = is_sampled ? states_.usual()
                                          : states_.memory() == localization::PatchMemory::kShared
                                              ? std::span<const float>(particles.shared_belief)
                                              : particles.belief(i);
    Slow result;
    std::vector<double> ratio(states_.columns(), 0.0);
    for (std::size_t beam = 0; beam < beams_.size(); ++beam) {
      find(particles, i, beam);
      const auto mix = [&](int s, int k) {
        return std::log(mix_events(events_, values_, end_, states_, belief, s, k));
      };
      const double log_p =
          is_sampled ? mix(particles.submap[i], particles.configuration[i]) : mix(-1, -1);
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
  void find(const localization::ParticleSet& particles, std::size_t i, std::size_t beam) const {
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
        const bool is_shared = states_.memory() == localization::PatchMemory::kShared;
        posterior.push_back(is_shared ? factor : factor * static_cast<double>(belief[column]));
        sum += is_shared ? 0.0 : posterior.back();
      }
      for (const double p : posterior) result.row.push_back(sum > 0.0 ? p / sum : p);
    }
  }

  const localization::PatchStates& states_;
  PatchRayCaster caster_;
  rays::ScanBeams beams_;
  rays::BeamMixture mixture_;
  mutable std::vector<RayEvent> events_;
  mutable std::vector<double> values_;
  mutable double end_ = 0.0;
};

}  // namespace strata::patch_beams::test_reference
