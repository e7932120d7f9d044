// SPDX-License-Identifier: Apache-2.0
/// The beams of a chunk of particles that meet cells which are obstacles in some configurations
/// only: found and followed many at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/patch_beams/chunk.hpp"
#include "core/patch_beams/patch_ray_caster.hpp"
#include "core/patch_beams/seen_boxes.hpp"
#include "core/patch_beams/single_beams.hpp"
#include "core/rays/scan_mixture.hpp"

namespace strata::patch_beams {

/// One beam of one particle that passes where sub-maps change.
struct ChangingBeam {
  std::uint32_t beam = 0;
  std::uint32_t particle = 0;    ///< of the chunk
  std::int32_t last_event = -1;  ///< place in events(); -1: it met nothing there
  std::int32_t events = 0;       ///< how many it met
  bool is_ended = false;         ///< one sub-map's configurations have all ended it
};

/// Working memory: find(), follow(); then what was found. Allocates nothing once warm.
///
/// Most beams meet something in one box alone, and all its cells are alike; these are kept apart,
/// as single().
class ChangingBeams {
 public:
  /// What a beam met, with what it says there. The configurations of `ray` are those that no
  /// earlier event of the same sub-map ended.
  struct Event {
    RayEvent ray;
    double log_likelihood = 0.0;
    std::int32_t previous = -1;  ///< the beam's event before this one
  };

  /// Lists the beams of all particles of a chunk that cross boxes, and forgets earlier ones.
  /// bundles: of caster.changing_table(). static_m: where each beam ends for certain, +infinity for
  /// nowhere, as of cast_bundles.
  void find(const rays::BeamBundles& bundles, SeenBoxes& boxes, const double* static_m);
  /// Follows all of them to where they end for certain. bundles: the same.
  void follow(const PatchRayCaster& caster, const rays::BeamBundles& bundles,
              const SeenBoxes& boxes, const ChunkStates& states, const rays::ScanMixture& mixture);

  [[nodiscard]] const SingleBeams& single() const { return single_; }
  /// The others.
  [[nodiscard]] std::span<const ChangingBeam> beams() const { return beams_; }
  [[nodiscard]] const Event& event(std::int32_t place) const {
    return events_[static_cast<std::size_t>(place)];
  }

 private:
  /// Rays on their way, in columns.
  struct Way {
    std::vector<double> bundle, column, row, cosine, sine, from_m, to_m, skip;
    std::vector<double> boxes;      ///< which it crosses, as BoxCrossings
    std::vector<std::uint32_t> of;  ///< place in beams_
    void resize(std::size_t count);
    void copy(std::size_t from, std::size_t to);
    void end(std::size_t count);  ///< makes those behind go nowhere
  };
  /// What a ray that has come to a cell is asked about.
  struct Round {
    const PatchRayCaster& caster;
    const SeenBoxes& boxes;
    const ChunkStates& states;
  };
  void take_multiple(const Round& round);
  void add_event(ChangingBeam& beam, const CellOwner& cells, double range_m, bool is_known,
                 std::uint64_t before, std::uint64_t all);
  void reserve_events(std::size_t more);
  void meet(const Round& round, std::size_t k, std::size_t& on);
  [[nodiscard]] bool may_meet_more(const Round& round, std::size_t k, std::int32_t last,
                                   std::uint64_t last_ended) const;
  [[nodiscard]] std::uint64_t ended(const ChangingBeam& beam, std::int32_t submap) const;

  double max_range_m_ = 0.0;
  Way way_;
  SingleBeams single_;
  std::vector<double> range_m_;
  std::vector<std::int32_t> mark_;
  std::vector<double> event_beam_, event_range_m_, event_log_;  // of each event
  std::vector<ChangingBeam> beams_;
  std::vector<std::pair<double, std::size_t>> met_;  // range and row
  std::vector<Event> events_;                        // event_count_ of them, and room for more
  std::size_t event_count_ = 0;
};

}  // namespace strata::patch_beams
