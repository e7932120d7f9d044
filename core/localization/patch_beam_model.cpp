// SPDX-License-Identifier: Apache-2.0
#include "core/localization/patch_beam_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace strata::localization {
namespace {

constexpr std::size_t kChunk = 64;
constexpr double kNothing = std::numeric_limits<double>::infinity();

std::uint64_t occupied_mask(const patch::PatchMap& map, std::size_t s, const Cell& cell) {
  std::uint64_t mask = 0;
  for (std::size_t k = 0; k < map.submaps[s].configurations.size(); ++k) {
    if (is_occupied(patch::reflection_at(map, s, k, cell))) mask |= std::uint64_t{1} << k;
  }
  return mask;
}

}  // namespace

PatchRayCaster::PatchRayCaster(const patch::PatchMap& map) {
  CellRect rect = map.base.rect();
  for (const patch::Submap& submap : map.submaps) {
    rect = rect.united(submap.rect);
    const std::size_t count = submap.configurations.size();
    all_.push_back(count >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1);
    for (const patch::Configuration& configuration : submap.configurations) {
      if (configuration.reflection.resolution_m() != map.base.resolution_m()) {
        throw InputError("sub-map " + std::to_string(submap.id),
                         "has another resolution than the base map", "learn the maps together");
      }
    }
  }
  Grid<std::uint8_t> marked(map.base.resolution_m(), rect);
  first_owner_ = Grid<std::int32_t>(map.base.resolution_m(), rect, -1);
  Grid<std::uint8_t> inside(map.base.resolution_m(), rect);
  for (const patch::Submap& submap : map.submaps) {
    for (int y = submap.rect.min.y; y < submap.rect.max.y; ++y) {
      for (int x = submap.rect.min.x; x < submap.rect.max.x; ++x) inside.at({x, y}) = 1;
    }
  }
  for (std::size_t i = 0; i < marked.size(); ++i) {
    const Cell cell = marked.cell(i);
    if (inside.values()[i] == 0) {
      marked.values()[i] = is_occupied(map.base.get(cell)) ? 1 : 0;
      continue;
    }
    std::vector<Owner> owners;
    std::uint64_t any = 0;
    for (const std::size_t s : patch::submaps_at(map, cell)) {
      owners.push_back({static_cast<std::int32_t>(s), occupied_mask(map, s, cell), false});
      any |= owners.back().mask;
    }
    if (any == 0) continue;
    marked.values()[i] = 1;
    owners.back().is_last = true;
    first_owner_.values()[i] = static_cast<std::int32_t>(owners_.size());
    owners_.insert(owners_.end(), owners.begin(), owners.end());
  }
  walker_ = RayWalker(marked);
}

void PatchRayCaster::events(double x_m, double y_m, double c, double s, double max_range_m,
                            int current, std::vector<RayEvent>& events) const {
  events.clear();
  const auto visit = [&](std::size_t index, double entry_m, double exit_m) {
    const double range_m = 0.5 * (entry_m + exit_m);
    const std::int32_t first = first_owner_.values()[index];
    if (first < 0) {
      events.push_back({-1, 0, range_m});
      return false;
    }
    const Owner* owner = &owners_[static_cast<std::size_t>(first)];
    for (const Owner* other = owner;; ++other) {
      if (other->submap == current) {
        owner = other;
        break;
      }
      if (other->is_last) break;
    }
    std::uint64_t ended = 0;
    for (const RayEvent& event : events) {
      if (event.submap == owner->submap) ended |= event.mask;
    }
    const std::uint64_t fresh = owner->mask & ~ended;
    if (fresh != 0) events.push_back({owner->submap, fresh, range_m});
    return (ended | fresh) != all_[static_cast<std::size_t>(owner->submap)];
  };
  walker_.walk(x_m, y_m, c, s, max_range_m, visit);
}

double mix_events(const std::vector<RayEvent>& events, const std::vector<double>& values,
                  double end_value, const PatchStates& states, std::span<const float> belief,
                  int fixed_submap, int fixed_patch) {
  const auto probability = [&](const RayEvent& event) {
    if (event.submap == fixed_submap) return (event.mask >> fixed_patch & 1U) != 0 ? 1.0 : 0.0;
    const auto s = static_cast<std::size_t>(event.submap);
    double sum = 0.0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(states.count(s)); ++k) {
      if ((event.mask >> k & 1U) != 0) sum += static_cast<double>(belief[states.offset(s) + k]);
    }
    return sum;
  };
  // P(no sub-map ended the beam before event `until`), leaving out sub-map `without`.
  const auto reach = [&](std::size_t until, std::int32_t without) {
    double product = 1.0;
    for (std::size_t e = 0; e < until; ++e) {
      const std::int32_t s = events[e].submap;
      bool is_first = s != without && s >= 0;
      for (std::size_t f = 0; f < e; ++f) is_first = is_first && events[f].submap != s;
      if (!is_first) continue;
      double ended = 0.0;
      for (std::size_t f = e; f < until; ++f) {
        if (events[f].submap == s) ended += probability(events[f]);
      }
      product *= std::max(0.0, 1.0 - ended);
    }
    return product;
  };
  double p = 0.0;
  for (std::size_t e = 0; e < events.size(); ++e) {
    const double before = reach(e, events[e].submap);
    if (events[e].submap < 0) return p + before * values[e];
    p += before * probability(events[e]) * values[e];
  }
  return p + reach(events.size(), -1) * end_value;
}

/// Working memory of one chunk of particles.
struct PatchBeamModel::Scratch {
  std::vector<RayEvent> events;
  std::vector<double> values;
  double end_value = 0.0;
  std::vector<double> log_ratio;  // per column: ln p(scan | m_s = k) - ln p(scan | beliefs)
  std::vector<double> factor;
};

PatchBeamModel::PatchBeamModel(std::shared_ptr<const patch::PatchMap> map,
                               const PatchBeamModelConfig& config)
    : config_(config), states_(map, config.states), caster_(*map) {
  require_valid(config, "patch_beam_model");
}

void PatchBeamModel::cast(const Pose2& map_from_laser, const ScanBeams& beams, std::size_t beam,
                          int current, const BeamMixture& mixture, Scratch& scratch) const {
  const double angle = map_from_laser.theta + beams.bearing_rad[beam];
  caster_.events(map_from_laser.x, map_from_laser.y, std::cos(angle), std::sin(angle),
                 beams.r_max_m, current, scratch.events);
  const bool is_hit = beams.is_hit[beam] != 0;
  scratch.values.clear();
  for (const RayEvent& event : scratch.events) {
    scratch.values.push_back(mixture.likelihood(is_hit, beams.range_m[beam], event.range_m));
  }
  scratch.end_value = mixture.likelihood(is_hit, beams.range_m[beam], kNothing);
}

double PatchBeamModel::weigh_sampled(const ScanBeams& beams, const BeamMixture& mixture,
                                     double tempering, const ParticleSet& particles, std::size_t i,
                                     Scratch& scratch) const {
  const Pose2 laser = particles.pose(i) * beams.robot_from_laser;
  const int current = particles.submap[i];
  double sum = 0.0;
  for (std::size_t k = 0; k < beams.size(); ++k) {
    cast(laser, beams, k, current, mixture, scratch);
    sum += std::log(mix_events(scratch.events, scratch.values, scratch.end_value, states_,
                               states_.uniform(), current, particles.patch[i]));
  }
  return sum / tempering;
}

double PatchBeamModel::weigh_remembered(const ScanBeams& beams, const BeamMixture& mixture,
                                        double tempering, ParticleSet& particles, std::size_t i,
                                        Scratch& scratch) const {
  const Pose2 laser = particles.pose(i) * beams.robot_from_laser;
  const int current = particles.submap[i];
  const bool is_shared = states_.memory() == PatchMemory::kShared;
  const std::span<const float> belief =
      is_shared ? std::span<const float>(particles.shared_belief) : particles.belief(i);
  std::fill(scratch.log_ratio.begin(), scratch.log_ratio.end(), 0.0);
  double sum = 0.0;
  for (std::size_t beam = 0; beam < beams.size(); ++beam) {
    cast(laser, beams, beam, current, mixture, scratch);
    const double mixed =
        mix_events(scratch.events, scratch.values, scratch.end_value, states_, belief);
    const double log_mixed = std::log(mixed);
    sum += log_mixed;
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
  // Scan-level mixture over the configurations of the particle's own sub-map.
  double own = 0.0;
  for (double& ratio : scratch.log_ratio) ratio /= tempering;
  if (current >= 0) {
    const auto s = static_cast<std::size_t>(current);
    const std::size_t offset = states_.offset(s);
    double largest = -kNothing;
    const auto count = static_cast<std::size_t>(states_.count(s));
    for (std::size_t k = 0; k < count; ++k) {
      largest = std::max(largest, scratch.log_ratio[offset + k]);
    }
    double total = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      total += static_cast<double>(belief[offset + k]) *
               std::exp(scratch.log_ratio[offset + k] - largest);
    }
    own = largest + std::log(total);
  }
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
  return sum / tempering + own;
}

std::size_t PatchBeamModel::log_likelihoods(const Scan& scan, double tempering,
                                            ParticleSet& particles,
                                            std::span<double> log_likelihood,
                                            WorkerPool& pool) const {
  const ScanBeams beams = select_beams(scan, config_.beam.beams);
  const BeamMixture mixture(config_.beam.mixture, beams.r_max_m);
  const bool is_sampled = states_.memory() == PatchMemory::kNone;
  pool.for_chunks(
      particles.size(), kChunk, [&](std::size_t begin, std::size_t end, std::size_t /*chunk*/) {
        Scratch scratch;
        scratch.log_ratio.resize(states_.columns());
        scratch.factor.resize(64);
        for (std::size_t i = begin; i < end; ++i) {
          log_likelihood[i] =
              is_sampled ? weigh_sampled(beams, mixture, tempering, particles, i, scratch)
                         : weigh_remembered(beams, mixture, tempering, particles, i, scratch);
        }
      });
  return beams.size();
}

double PatchBeamModel::explained_share(const Scan& scan, const Pose2& map_from_robot,
                                       const ParticleSet& particles) const {
  const ScanBeams beams = select_beams(scan, config_.beam.beams);
  if (beams.size() == 0) return 1.0;
  const BeamMixture mixture(config_.beam.mixture, beams.r_max_m);
  const Pose2 laser = map_from_robot * beams.robot_from_laser;
  std::vector<float> belief;
  for (const SubmapBelief& submap : states_.posterior(particles)) {
    for (const double p : submap.probability) belief.push_back(static_cast<float>(p));
  }
  const int current = patch::submap_at(states_.map(), map_from_robot.translation());
  Scratch scratch;
  double explained = 0.0;
  for (std::size_t beam = 0; beam < beams.size(); ++beam) {
    cast(laser, beams, beam, current, mixture, scratch);
    const bool is_hit = beams.is_hit[beam] != 0;
    for (std::size_t e = 0; e < scratch.events.size(); ++e) {
      scratch.values[e] =
          mixture.explains(is_hit, beams.range_m[beam], scratch.events[e].range_m) ? 1.0 : 0.0;
    }
    const double end = mixture.explains(is_hit, beams.range_m[beam], kNothing) ? 1.0 : 0.0;
    explained += mix_events(scratch.events, scratch.values, end, states_, belief);
  }
  return explained / static_cast<double>(beams.size());
}

}  // namespace strata::localization
