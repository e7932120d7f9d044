// SPDX-License-Identifier: Apache-2.0
/// The beams of a chunk of particles that meet cells which are obstacles in some configurations
/// only: found and followed many at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/localization/patch_ray_caster.hpp"
#include "core/localization/scan_beams.hpp"
#include "core/localization/scan_mixture.hpp"

namespace strata::localization {

/// One beam of one particle that passes where sub-maps change.
struct ChangingBeam {
  std::uint32_t beam = 0;
  std::int32_t last_event = -1;  ///< place in events(); -1: it met nothing there
  std::int32_t events = 0;       ///< how many it met
  bool is_ended = false;         ///< one sub-map's configurations have all ended it
};

/// Working memory: begin(), add() for each particle, follow(); then what was found. Allocates
/// nothing once warm.
class ChangingBeams {
 public:
  /// What a beam met, with what it says there. The configurations of `ray` are those that no
  /// earlier event of the same sub-map ended.
  struct Event {
    RayEvent ray;
    double log_likelihood = 0.0;
    std::int32_t previous = -1;  ///< the beam's event before this one
  };

  void begin();
  /// The next particle, in sub-map `current`; fixed: the one configuration that counts there, -1
  /// for all. static_m: where each beam of the fan ends for certain, +infinity for nowhere. boxes:
  /// those of caster.boxes() that are near, relative to the laser.
  void add(const PatchRayCaster& caster, const RayFan& fan, const double* static_m,
           std::span<const RayBox> boxes, int current = -1, int fixed = -1);
  /// Follows all beams of all particles to where they end for certain.
  void follow(const PatchRayCaster& caster, const ScanMixture& mixture);

  /// Those of particle n, in the order of its beams.
  [[nodiscard]] std::span<const ChangingBeam> beams(std::size_t n) const {
    return std::span<const ChangingBeam>(beams_).subspan(begins_[n], begins_[n + 1] - begins_[n]);
  }
  [[nodiscard]] const Event& event(std::int32_t place) const {
    return events_[static_cast<std::size_t>(place)];
  }

 private:
  /// Rays on their way, in columns.
  struct Way {
    std::vector<double> beam, column, row, cosine, sine, from_m, to_m, skip;
    std::vector<double> boxes;      ///< which of the particle's it crosses, as RayCrossings
    std::vector<std::uint32_t> of;  ///< place in beams_
    void resize(std::size_t count);
    void copy(std::size_t from, std::size_t to);
  };
  struct Seen {
    std::int32_t current = -1;
    std::int32_t fixed = -1;
    std::size_t first_box = 0;  ///< in boxes_, as many as it has
    bool is_named = true;       ///< none of its boxes is without a number
  };
  void meet(const PatchRayCaster& caster, std::size_t k, std::size_t& on);
  [[nodiscard]] bool may_meet_more(std::size_t k, const Seen& seen, std::int32_t last,
                                   std::uint64_t last_ended) const;
  [[nodiscard]] std::uint64_t ended(const ChangingBeam& beam, std::int32_t submap) const;

  double max_range_m_ = 0.0;
  Way way_;
  std::size_t rays_ = 0;
  std::vector<double> range_m_;
  std::vector<std::int32_t> mark_;
  std::vector<double> event_beam_, event_range_m_, event_log_;  // of each event
  std::vector<ChangingBeam> beams_;
  std::vector<std::uint32_t> particle_;  // of each beam
  std::vector<Seen> seen_;               // of each particle
  std::vector<std::size_t> begins_;
  std::vector<CellOwner> boxes_;  // what counts in those of each particle; -1: several sub-maps
  std::vector<Event> events_;     // event_count_ of them, and room for more
  std::size_t event_count_ = 0;
};

}  // namespace strata::localization
