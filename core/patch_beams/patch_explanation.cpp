// SPDX-License-Identifier: Apache-2.0
#include "core/patch_beams/patch_explanation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/patch_beams/event_mixture.hpp"
#include "core/rays/ray_kernel.hpp"

namespace strata::patch_beams {
namespace {

constexpr double kNothing = std::numeric_limits<double>::infinity();

/// The stages of a chunk of particles for one laser: a vector of beams at a time where they end for
/// certain, then the rest.
void find_ends(const PreparedScan& scan, const PatchRayCaster& caster, const Pose2& laser,
               int current, ExplanationMemory& memory) {
  const rays::ScanBeams& beams = scan.beams;
  memory.lasers.take(laser);
  memory.range_m.resize(beams.size());
  memory.cells.resize(beams.size());
  rays::cast_rays(caster.static_table(),
                  {laser.x, laser.y, std::cos(laser.theta), std::sin(laser.theta),
                   beams.cosine.data(), beams.sine.data(), beams.size(), beams.r_max_m},
                  memory.range_m.data(), memory.cells.data());
  const std::size_t row = memory.lasers.padded();
  memory.static_m.resize(beams.size() * row);
  for (std::size_t beam = 0; beam < beams.size(); ++beam) {
    std::fill_n(memory.static_m.begin() + static_cast<std::ptrdiff_t>(beam * row), row,
                memory.range_m[beam]);
  }
  const std::int32_t submap = current;
  find_changing(scan, caster, {std::span(&submap, 1), {}}, memory.static_m.data(), memory.lasers,
                memory.changing);
}

/// What each beam of one laser may end at, the nearest first; beams are asked for in order.
class EventsInOrder {
 public:
  EventsInOrder(const PatchRayCaster& caster, const ChangingEnds& ends,
                std::span<const double> static_m)
      : caster_(caster), ends_(ends), static_m_(static_m) {}

  void next(std::size_t beam, std::vector<RayEvent>& events) {
    const SingleBeams& single = ends_.beams.single();
    events.clear();
    bool is_ended = false;
    // One row a beam and box: only the first bundle counts.
    while (at_single_ < single.size() && single.row(at_single_).beam == beam) {
      const CellOwner& cells = ends_.boxes.content(single.row(at_single_).box, 0);
      const double range_m = *single.range_m(at_single_++);
      if (!std::isfinite(range_m)) continue;
      events.push_back({cells.submap, cells.mask, range_m});
      is_ended = cells.mask == caster_.all(cells.submap);
    }
    for (const ChangingBeam& other : ends_.beams.beams()) {
      if (other.beam != beam) continue;
      for (std::int32_t e = other.last_event; e >= 0; e = ends_.beams.event(e).previous) {
        events.push_back(ends_.beams.event(e).ray);
      }
      std::reverse(events.begin(), events.end());
      is_ended = other.is_ended;
    }
    if (!is_ended && std::isfinite(static_m_[beam])) events.push_back({-1, 0, static_m_[beam]});
  }

 private:
  const PatchRayCaster& caster_;
  const ChangingEnds& ends_;
  std::span<const double> static_m_;  // of each beam
  std::size_t at_single_ = 0;
};

/// Whether the pose is one that the map knows, and the beams that it judges there.
struct Judge {
  const PatchRayCaster& caster;
  const rays::ScanBeams& beams;
  const rays::BeamMixture& mixture;
  const Pose2& laser;
  bool is_known_here;

  /// share(counts): the probability that the beam ends at a range, +infinity for nowhere, of which
  /// counts(range) is true. Adds the beam to the sums.
  template <typename Share>
  void add(std::size_t beam, Share&& share, localization::InlierShares& said) const {
    const bool is_hit = beams.is_hit[beam] != 0;
    const double range_m = beams.range_m[beam];
    // From where the map knows nothing, it would expect nothing of any beam.
    const auto is_inlier = [&](double expected_m) {
      return (is_hit || is_known_here) && mixture.is_inlier(is_hit, range_m, expected_m);
    };
    const double inlier = share(is_inlier);
    if (inlier == 1.0) {  // as most are: all shares are 1, and none is stopped
      said.inlier += 1.0;
      said.judged += 1.0;
      said.at_surface += 1.0;
      return;
    }
    const Eigen::Vector2d end_m = beams.end_m(laser, beam);
    const double inlier_or_before =
        share([&](double expected_m) { return is_inlier(expected_m) || expected_m < range_m; });
    const bool is_known =
        localization::knows_end(caster, laser.translation(), end_m, mixture.tolerance_m());
    const double judged = is_known ? 1.0 : inlier_or_before;
    const bool is_near = is_hit && caster.is_near_surface(end_m, mixture.surface_tolerance_m());
    said.inlier += inlier;
    said.judged += judged;
    said.at_surface += is_near ? judged : inlier;
    said.stopped += is_hit && !is_near ? judged - inlier_or_before : 0.0;
  }
};

}  // namespace

localization::InlierShares explain_beams(const PreparedScan& scan, const PatchRayCaster& caster,
                                         const localization::PatchStates& layout,
                                         const Pose2& map_from_laser, int current,
                                         std::span<const float> belief, ExplanationMemory& memory) {
  localization::InlierShares said;
  if (scan.beams.size() == 0) return said;
  find_ends(scan, caster, map_from_laser, current, memory);
  EventsInOrder events(caster, memory.changing, memory.range_m);
  const Judge judge{caster, scan.beams, scan.mixture.mixture(), map_from_laser,
                    caster.knows(map_from_laser.translation())};
  for (std::size_t beam = 0; beam < scan.beams.size(); ++beam) {
    events.next(beam, memory.events);
    const auto share = [&](auto&& counts) {
      memory.values.clear();
      for (const RayEvent& event : memory.events) {
        memory.values.push_back(counts(event.range_m) ? 1.0 : 0.0);
      }
      const double end = counts(kNothing) ? 1.0 : 0.0;
      return mix_events(memory.events, memory.values, end, layout, belief);
    };
    judge.add(beam, share, said);
  }
  said.met = said.inlier;
  said.divide_by(static_cast<double>(scan.beams.size()));
  return said;
}

}  // namespace strata::patch_beams
