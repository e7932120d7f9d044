// SPDX-License-Identifier: Apache-2.0
#include "core/localization/patch_beam_model.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/localization/column_math.hpp"

namespace strata::localization {
namespace {

// Twice as many as without sub-maps: what is found once a chunk costs more here.
constexpr std::size_t kChunk = 128;
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

/// Casts the beams of the lasers to where they end for certain, and finds those that may end
/// before.
void PatchBeamModel::cast(const ScanScratch& scan, const ChunkStates& states,
                          Scratch& scratch) const {
  const ScanBeams& beams = scan.beams;
  LaserColumns& lasers = scratch.lasers;
  const std::size_t places = beams.size() * lasers.padded();
  scratch.static_m.resize(places);
  scratch.logs.resize(places);
  const RayTable still = caster_.static_table();
  cast_fans(still, lasers.fans(still, beams, beams.r_max_m), scratch.static_m.data());
  scan.mixture.log_likelihoods_of_fans(lasers.padded(), scratch.static_m.data(),
                                       scratch.logs.data());
  scratch.boxes.take(caster_, lasers, states, beams.r_max_m);
  const RayFans fans = lasers.fans(caster_.changing_table(), beams, beams.r_max_m);
  scratch.changing.find(fans, scratch.boxes, scratch.static_m.data());
  scratch.changing.follow(caster_, fans, scratch.boxes, states, scan.mixture);
}

std::size_t PatchBeamModel::log_likelihoods(const Scan& scan, const Weighing& weighing,
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
    scratch->lasers.take(particles, begin, end, said->beams.robot_from_laser);
    const std::size_t row = scratch->lasers.padded();
    const ChunkStates states{
        std::span<const std::int32_t>(particles.submap).subspan(begin, end - begin),
        std::span<const std::int32_t>(particles.patch)
            .subspan(begin, is_sampled ? end - begin : 0)};
    cast(*said, states, *scratch);
    const Beliefs believed = beliefs(particles, begin);
    list_beams(believed, *scratch);
    mix_single(said->mixture, believed, states, *scratch);
    mix_pairs(*scratch);
    mix_others(believed, states, *scratch);
    scratch->sums.resize(row);
    sum_rows(scratch->logs.data(), beams, row, scratch->sums.data());
    for (std::size_t i = begin; i < end; ++i) {
      log_likelihood[i] =
          (scratch->sums[i - begin] + scratch->single_log[i - begin]) / weighing.tempering;
    }
    if (!is_sampled) remember(weighing.tempering, particles, begin, end, log_likelihood, *scratch);
  };
  pool.for_chunks(particles.size(), kChunk, std::cref(weigh));
  return beams;
}

/// The beams from one laser, as cast() does those of particles.
void PatchBeamModel::cast_one(const ScanScratch& scan, const Pose2& laser, int current,
                              Scratch& scratch) const {
  const ScanBeams& beams = scan.beams;
  scratch.lasers.take(laser);
  const std::size_t row = scratch.lasers.padded();
  scratch.cells.resize(beams.size());
  scratch.logs.resize(beams.size());
  cast_rays(caster_.static_table(),
            {laser.x, laser.y, std::cos(laser.theta), std::sin(laser.theta), beams.cosine.data(),
             beams.sine.data(), beams.size(), beams.r_max_m},
            scratch.logs.data(), scratch.cells.data());
  scratch.static_m.resize(beams.size() * row);
  for (std::size_t beam = 0; beam < beams.size(); ++beam) {
    std::fill_n(scratch.static_m.begin() + static_cast<std::ptrdiff_t>(beam * row), row,
                scratch.logs[beam]);
  }
  const std::int32_t submap = current;
  const ChunkStates states{std::span(&submap, 1), {}};
  scratch.boxes.take(caster_, scratch.lasers, states, beams.r_max_m);
  const RayFans fans = scratch.lasers.fans(caster_.changing_table(), beams, beams.r_max_m);
  scratch.changing.find(fans, scratch.boxes, scratch.static_m.data());
  scratch.changing.follow(caster_, fans, scratch.boxes, states, scan.mixture);
}

/// What each beam of cast_one() may end at, the nearest first, into `events`; beams come in order.
class PatchBeamModel::EventsInOrder {
 public:
  EventsInOrder(const PatchRayCaster& caster, const Scratch& scratch)
      : caster_(caster), scratch_(scratch), single_(scratch.changing.single()) {}

  void next(std::size_t beam, std::vector<RayEvent>& events) {
    events.clear();
    bool is_ended = false;
    // One row a beam and box: only the first fan counts.
    while (at_single_ < single_.size() && single_.row(at_single_).beam == beam) {
      const CellOwner& cells = scratch_.boxes.content(single_.row(at_single_).box, 0);
      const double range_m = *single_.range_m(at_single_++);
      if (!std::isfinite(range_m)) continue;
      events.push_back({cells.submap, cells.mask, range_m});
      is_ended = cells.mask == caster_.all(cells.submap);
    }
    for (const ChangingBeam& other : scratch_.changing.beams()) {
      if (other.beam != beam) continue;
      for (std::int32_t e = other.last_event; e >= 0; e = scratch_.changing.event(e).previous) {
        events.push_back(scratch_.changing.event(e).ray);
      }
      std::reverse(events.begin(), events.end());
      is_ended = other.is_ended;
    }
    const double end_m = scratch_.static_m[beam * scratch_.lasers.padded()];
    if (!is_ended && std::isfinite(end_m)) events.push_back({-1, 0, end_m});
  }

 private:
  const PatchRayCaster& caster_;
  const Scratch& scratch_;
  const SingleBeams& single_;
  std::size_t at_single_ = 0;
};

Explanation PatchBeamModel::explain(const Scan& scan, const Pose2& map_from_robot,
                                    const ParticleSet& particles) const {
  const auto scan_scratch = scan_scratch_.borrow();
  ScanBeams& beams = scan_scratch->beams;
  select_beams(scan, config_.beam.beams, beams);
  if (beams.size() == 0) return {};
  const BeamMixture mixture = mixture_.limited_to(beams.r_max_m);
  scan_scratch->mixture.prepare(mixture, beams);
  const Pose2 laser = map_from_robot * beams.robot_from_laser;
  const auto scratch = scratch_.borrow();
  states_.posterior(particles, scratch->posterior);
  scratch->belief.clear();
  for (const SubmapBelief& submap : scratch->posterior) {
    for (const double p : submap.probability) scratch->belief.push_back(static_cast<float>(p));
  }
  const int current = states_.submap_of(map_from_robot.translation());
  cast_one(*scan_scratch, laser, current, *scratch);
  EventsInOrder events(caster_, *scratch);
  Explanation said;
  const bool is_known_here = caster_.knows(laser.translation());
  for (std::size_t beam = 0; beam < beams.size(); ++beam) {
    events.next(beam, scratch->events);
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
    const double explained = share(explains);
    if (explained == 1.0) {  // as most are: all shares are 1, and none is stopped
      said.explained += 1.0;
      said.judged += 1.0;
      said.at_surface += 1.0;
      continue;
    }
    const Eigen::Vector2d end_m = beams.end_m(laser, beam);
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
