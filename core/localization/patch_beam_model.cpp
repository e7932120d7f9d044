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

/// Boxes within reach of any particle of the chunk.
void PatchBeamModel::find_boxes(const ScanBeams& beams, const ParticleSet& particles,
                                std::size_t begin, std::size_t end, Scratch& scratch) const {
  scratch.chunk_boxes.clear();
  if (caster_.boxes().empty()) return;
  const auto from = static_cast<std::ptrdiff_t>(begin);
  const auto to = static_cast<std::ptrdiff_t>(end);
  const auto [low_x, high_x] =
      std::minmax_element(particles.x_m.begin() + from, particles.x_m.begin() + to);
  const auto [low_y, high_y] =
      std::minmax_element(particles.y_m.begin() + from, particles.y_m.begin() + to);
  const Pose2& mounting = beams.robot_from_laser;
  const double reach = beams.r_max_m + std::hypot(mounting.x, mounting.y);
  for (const RayBox& box : caster_.boxes()) {
    if (box.min_x_m < *high_x + reach && box.max_x_m > *low_x - reach &&
        box.min_y_m < *high_y + reach && box.max_y_m > *low_y - reach) {
      scratch.chunk_boxes.push_back(box);
    }
  }
}

/// Casts the beams of all particles to where they end for certain, and finds those that may end
/// before.
void PatchBeamModel::cast(const ScanScratch& scan, const ParticleSet& particles, std::size_t begin,
                          std::size_t end, Scratch& scratch) const {
  const ScanBeams& beams = scan.beams;
  const bool is_sampled = states_.memory() == PatchMemory::kNone;
  scratch.static_m.resize(beams.size());
  scratch.cells.resize(beams.size());
  scratch.logs.resize(kChunk * beams.size());
  scratch.changing.begin();
  find_boxes(beams, particles, begin, end, scratch);
  for (std::size_t i = begin; i < end; ++i) {
    const Pose2 laser = particles.pose(i) * beams.robot_from_laser;
    const RayFan fan{laser.x,
                     laser.y,
                     std::cos(laser.theta),
                     std::sin(laser.theta),
                     beams.cosine.data(),
                     beams.sine.data(),
                     beams.size(),
                     beams.r_max_m};
    caster_.cast_static(fan, scratch.static_m.data(), scratch.cells.data());
    scan.mixture.log_likelihoods(0, beams.size(), scratch.static_m.data(),
                                 scratch.logs.data() + (i - begin) * beams.size());
    const int fixed = is_sampled ? particles.patch[i] : -1;
    scratch.boxes.clear();
    for (const RayBox& box : scratch.chunk_boxes) {
      if (!caster_.may_end_beams(box, particles.submap[i], fixed)) continue;
      RayBox seen = caster_.seen(box, particles.submap[i]);
      seen.min_x_m -= laser.x;
      seen.max_x_m -= laser.x;
      seen.min_y_m -= laser.y;
      seen.max_y_m -= laser.y;
      const double dx = std::max({seen.min_x_m, -seen.max_x_m, 0.0});
      const double dy = std::max({seen.min_y_m, -seen.max_y_m, 0.0});
      seen.near_m = std::max(dx, dy);
      if (dx * dx + dy * dy < beams.r_max_m * beams.r_max_m) scratch.boxes.push_back(seen);
    }
    scratch.changing.add(caster_, fan, scratch.static_m.data(), scratch.boxes, particles.submap[i],
                         fixed);
  }
  scratch.changing.follow(caster_, scan.mixture);
}

std::size_t PatchBeamModel::log_likelihoods(const Scan& scan, double tempering,
                                            ParticleSet& particles,
                                            std::span<double> log_likelihood,
                                            WorkerPool& pool) const {
  const auto said = scan_scratch_.borrow();
  select_beams(scan, config_.beam.beams, said->beams);
  said->mixture.prepare(mixture_.limited_to(said->beams.r_max_m), said->beams);
  const std::size_t beams = said->beams.size();
  const bool is_sampled = states_.memory() == PatchMemory::kNone;
  const auto weigh = [&](std::size_t begin, std::size_t end, std::size_t /*chunk*/) {
    const auto scratch = scratch_.borrow();
    cast(*said, particles, begin, end, *scratch);
    list_beams(particles, begin, end, *scratch);
    mix_pairs(*scratch);
    mix_others(particles, *scratch);
    for (std::size_t i = begin; i < end; ++i) {
      log_likelihood[i] = sum_of(scratch->logs.data() + (i - begin) * beams, beams) / tempering;
    }
    if (!is_sampled) remember(tempering, particles, begin, end, log_likelihood, *scratch);
  };
  pool.for_chunks(particles.size(), kChunk, std::cref(weigh));
  return beams;
}

Explanation PatchBeamModel::explain(const Scan& scan, const Pose2& map_from_robot,
                                    const ParticleSet& particles) const {
  const auto scan_scratch = scan_scratch_.borrow();
  ScanBeams& beams = scan_scratch->beams;
  select_beams(scan, config_.beam.beams, beams);
  if (beams.size() == 0) return {};
  const BeamMixture mixture = mixture_.limited_to(beams.r_max_m);
  const Pose2 laser = map_from_robot * beams.robot_from_laser;
  const auto scratch = scratch_.borrow();
  states_.posterior(particles, scratch->posterior);
  scratch->belief.clear();
  for (const SubmapBelief& submap : scratch->posterior) {
    for (const double p : submap.probability) scratch->belief.push_back(static_cast<float>(p));
  }
  const int current = patch::submap_at(states_.map(), map_from_robot.translation());
  const double hc = std::cos(laser.theta);
  const double hs = std::sin(laser.theta);
  Explanation said;
  const bool is_known_here = caster_.knows(laser.translation());
  for (std::size_t beam = 0; beam < beams.size(); ++beam) {
    const double c = hc * beams.cosine[beam] - hs * beams.sine[beam];
    const double s = hs * beams.cosine[beam] + hc * beams.sine[beam];
    caster_.events(laser.x, laser.y, c, s, beams.r_max_m, current, scratch->events);
    const bool is_hit = beams.is_hit[beam] != 0;
    const double range_m = beams.range_m[beam];
    const auto share = [&](auto&& counts) {
      scratch->value.clear();
      for (const RayEvent& event : scratch->events) {
        scratch->value.push_back(counts(event.range_m) ? 1.0 : 0.0);
      }
      const double end = counts(kNothing) ? 1.0 : 0.0;
      return mix_events(scratch->events, scratch->value, end, states_, scratch->belief);
    };
    // From where the map knows nothing, it would expect nothing of any beam.
    const auto explains = [&](double expected_m) {
      return (is_hit || is_known_here) && mixture.explains(is_hit, range_m, expected_m);
    };
    const Eigen::Vector2d end_m = beams.end_m(laser, beam);
    const double explained = share(explains);
    const double explained_or_before =
        share([&](double expected_m) { return explains(expected_m) || expected_m < range_m; });
    const bool is_known = knows_end(caster_, laser.translation(), end_m, mixture.tolerance_m());
    const double judged = is_known ? 1.0 : explained_or_before;
    const bool is_near = is_hit && caster_.is_near_surface(end_m, mixture.surface_tolerance_m());
    said.explained += explained;
    said.judged += judged;
    said.at_surface += is_near ? judged : explained;
    said.stopped += is_hit && !is_near ? judged - explained_or_before : 0.0;
  }
  said.met = said.explained;
  said.divide_by(static_cast<double>(beams.size()));
  return said;
}

}  // namespace strata::localization
