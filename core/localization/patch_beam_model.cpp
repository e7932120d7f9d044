// SPDX-License-Identifier: Apache-2.0
#include "core/localization/patch_beam_model.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/localization/particle_kernels.hpp"

namespace strata::localization {
namespace {

constexpr std::size_t kChunk = 64;
constexpr double kNothing = std::numeric_limits<double>::infinity();

}  // namespace

PatchBeamModel::PatchBeamModel(std::shared_ptr<const patch::PatchMap> map,
                               const PatchBeamModelConfig& config)
    : config_(config),
      states_(map, config.states),
      caster_(*map),
      mixture_(config.beam.mixture, 1.0) {
  require_valid(config, "patch_beam_model");
}

void PatchBeamModel::cast_all(const Pose2& laser, const ScanBeams& beams, Scratch& scratch) const {
  scratch.expected.resize(beams.size());
  scratch.cells.resize(beams.size());
  scratch.logs.resize(beams.size());
  scratch.heading_cosine = std::cos(laser.theta);
  scratch.heading_sine = std::sin(laser.theta);
  caster_.cast({laser.x, laser.y, scratch.heading_cosine, scratch.heading_sine, beams.cosine.data(),
                beams.sine.data(), beams.size(), beams.r_max_m},
               scratch.expected.data(), scratch.cells.data());
}

void PatchBeamModel::find_events(const Pose2& laser, const ScanBeams& beams, std::size_t beam,
                                 int current, const BeamMixture& mixture, Scratch& scratch) const {
  const double hc = scratch.heading_cosine;
  const double hs = scratch.heading_sine;
  const double c = hc * beams.cosine[beam] - hs * beams.sine[beam];
  const double s = hs * beams.cosine[beam] + hc * beams.sine[beam];
  caster_.events(laser.x, laser.y, c, s, beams.r_max_m, current, scratch.events);
  const bool is_hit = beams.is_hit[beam] != 0;
  scratch.values.clear();
  for (const RayEvent& event : scratch.events) {
    scratch.values.push_back(mixture.likelihood(is_hit, beams.range_m[beam], event.range_m));
  }
  scratch.end_value = mixture.likelihood(is_hit, beams.range_m[beam], kNothing);
}

double PatchBeamModel::weigh_sampled(const ScanScratch& scan, double tempering,
                                     const ParticleSet& particles, std::size_t i,
                                     Scratch& scratch) const {
  const ScanBeams& beams = scan.beams;
  const Pose2 laser = particles.pose(i) * beams.robot_from_laser;
  const int current = particles.submap[i];
  cast_all(laser, beams, scratch);
  scan.mixture.log_likelihoods(0, beams.size(), scratch.expected.data(), scratch.logs.data());
  for (std::size_t k = 0; k < beams.size(); ++k) {
    // Most beams end where all configurations agree.
    if (scratch.cells[k] < 0 || caster_.is_certain(scratch.cells[k])) continue;
    find_events(laser, beams, k, current, scan.mixture.mixture(), scratch);
    scratch.logs[k] = std::log(mix_events(scratch.events, scratch.values, scratch.end_value,
                                          states_, states_.uniform(), current, particles.patch[i]));
  }
  return sum_of(scratch.logs.data(), beams.size()) / tempering;
}

void PatchBeamModel::compare_configurations(std::span<const float> belief, double log_mixed,
                                            Scratch& scratch) const {
  for (std::size_t e = 0; e < scratch.events.size(); ++e) {
    const std::int32_t s = scratch.events[e].submap;
    bool is_first = s >= 0;
    for (std::size_t f = 0; f < e; ++f) is_first = is_first && scratch.events[f].submap != s;
    if (!is_first) continue;
    const std::size_t offset = states_.offset(static_cast<std::size_t>(s));
    for (int k = 0; k < states_.count(static_cast<std::size_t>(s)); ++k) {
      const double fixed =
          mix_events(scratch.events, scratch.values, scratch.end_value, states_, belief, s, k);
      scratch.log_ratio[offset + static_cast<std::size_t>(k)] += std::log(fixed) - log_mixed;
    }
  }
}

/// Scan-level mixture over the configurations of the particle's own sub-map.
double PatchBeamModel::own_mixture(std::span<const float> belief, int current,
                                   const Scratch& scratch) const {
  if (current < 0) return 0.0;
  const auto s = static_cast<std::size_t>(current);
  const std::size_t offset = states_.offset(s);
  const auto count = static_cast<std::size_t>(states_.count(s));
  double largest = -kNothing;
  for (std::size_t k = 0; k < count; ++k) {
    largest = std::max(largest, scratch.log_ratio[offset + k]);
  }
  double total = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    total +=
        static_cast<double>(belief[offset + k]) * std::exp(scratch.log_ratio[offset + k] - largest);
  }
  return largest + std::log(total);
}

double PatchBeamModel::weigh_remembered(const ScanScratch& scan, double tempering,
                                        ParticleSet& particles, std::size_t i,
                                        Scratch& scratch) const {
  const ScanBeams& beams = scan.beams;
  const Pose2 laser = particles.pose(i) * beams.robot_from_laser;
  const int current = particles.submap[i];
  const bool is_shared = states_.memory() == PatchMemory::kShared;
  const std::span<const float> belief =
      is_shared ? std::span<const float>(particles.shared_belief) : particles.belief(i);
  std::fill(scratch.log_ratio.begin(), scratch.log_ratio.end(), 0.0);
  cast_all(laser, beams, scratch);
  scan.mixture.log_likelihoods(0, beams.size(), scratch.expected.data(), scratch.logs.data());
  for (std::size_t beam = 0; beam < beams.size(); ++beam) {
    if (scratch.cells[beam] < 0 || caster_.is_certain(scratch.cells[beam])) continue;
    find_events(laser, beams, beam, current, scan.mixture.mixture(), scratch);
    scratch.logs[beam] =
        std::log(mix_events(scratch.events, scratch.values, scratch.end_value, states_, belief));
    compare_configurations(belief, scratch.logs[beam], scratch);
  }
  for (double& ratio : scratch.log_ratio) ratio /= tempering;
  const double own = own_mixture(belief, current, scratch);
  const std::span<float> row = particles.belief(i);
  for (std::size_t s = 0; s < states_.map().submaps.size(); ++s) {
    const std::size_t offset = states_.offset(s);
    const auto count = static_cast<std::size_t>(states_.count(s));
    for (std::size_t k = 0; k < count; ++k) {
      // What absorb() sums: p(z | x_i, m_s = k) over the particle's own likelihood.
      const double factor = std::exp(std::min(80.0, scratch.log_ratio[offset + k] - own));
      if (is_shared) row[offset + k] = static_cast<float>(factor);
      scratch.factor[k] = factor;
    }
    if (!is_shared) {
      update_belief(row.subspan(offset, count), {scratch.factor.data(), count},
                    states_.least_belief());
    }
  }
  return sum_of(scratch.logs.data(), beams.size()) / tempering + own;
}

std::size_t PatchBeamModel::log_likelihoods(const Scan& scan, double tempering,
                                            ParticleSet& particles,
                                            std::span<double> log_likelihood,
                                            WorkerPool& pool) const {
  const auto said = scan_scratch_.borrow();
  select_beams(scan, config_.beam.beams, said->beams);
  said->mixture.prepare(mixture_.limited_to(said->beams.r_max_m), said->beams);
  const bool is_sampled = states_.memory() == PatchMemory::kNone;
  const auto weigh = [&](std::size_t begin, std::size_t end, std::size_t /*chunk*/) {
    const auto scratch = scratch_.borrow();
    scratch->log_ratio.resize(states_.columns());
    scratch->factor.resize(64);
    for (std::size_t i = begin; i < end; ++i) {
      log_likelihood[i] = is_sampled ? weigh_sampled(*said, tempering, particles, i, *scratch)
                                     : weigh_remembered(*said, tempering, particles, i, *scratch);
    }
  };
  pool.for_chunks(particles.size(), kChunk, std::cref(weigh));
  return said->beams.size();
}

double PatchBeamModel::explained_share(const Scan& scan, const Pose2& map_from_robot,
                                       const ParticleSet& particles) const {
  const auto said = scan_scratch_.borrow();
  ScanBeams& beams = said->beams;
  select_beams(scan, config_.beam.beams, beams);
  if (beams.size() == 0) return 1.0;
  const BeamMixture mixture = mixture_.limited_to(beams.r_max_m);
  const Pose2 laser = map_from_robot * beams.robot_from_laser;
  const auto scratch = scratch_.borrow();
  states_.posterior(particles, scratch->posterior);
  scratch->belief.clear();
  for (const SubmapBelief& submap : scratch->posterior) {
    for (const double p : submap.probability) scratch->belief.push_back(static_cast<float>(p));
  }
  const int current = patch::submap_at(states_.map(), map_from_robot.translation());
  scratch->heading_cosine = std::cos(laser.theta);
  scratch->heading_sine = std::sin(laser.theta);
  double explained = 0.0;
  for (std::size_t beam = 0; beam < beams.size(); ++beam) {
    find_events(laser, beams, beam, current, mixture, *scratch);
    const bool is_hit = beams.is_hit[beam] != 0;
    for (std::size_t e = 0; e < scratch->events.size(); ++e) {
      scratch->values[e] =
          mixture.explains(is_hit, beams.range_m[beam], scratch->events[e].range_m) ? 1.0 : 0.0;
    }
    const double end = mixture.explains(is_hit, beams.range_m[beam], kNothing) ? 1.0 : 0.0;
    explained += mix_events(scratch->events, scratch->values, end, states_, scratch->belief);
  }
  return explained / static_cast<double>(beams.size());
}

}  // namespace strata::localization
