// SPDX-License-Identifier: Apache-2.0
/// Beams in a map of which some parts are in one of several configurations.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "core/localization/patch_states.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/localization/ray_caster.hpp"
#include "core/localization/sensor_model.hpp"

namespace strata::localization {

struct PatchBeamModelConfig {
  BeamModelConfig beam;
  PatchStatesConfig states;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("beam", c.beam, "the beam model, the same as for other maps");
    v.group("states", c.states, "how configurations are remembered and forgotten");
  }
};

/// Where a ray may end: at `range_m`, for the configurations `mask` of a sub-map.
struct RayEvent {
  std::int32_t submap = -1;  ///< -1: the static map, where every remaining beam ends
  std::uint64_t mask = 0;    ///< configurations whose first obstacle on the ray this is
  double range_m = 0.0;
};

/// All first obstacles of all configurations along a ray, near ones first.
class PatchRayCaster {
 public:
  /// Occupied: is_occupied; unknown is transparent. The static map counts outside the rectangles.
  /// Throws InputError for grids of different resolution.
  explicit PatchRayCaster(const patch::PatchMap& map);

  /// Fills `events` (cleared first), in order of range. current: the sub-map of the particle, whose
  /// cells win where rectangles overlap; elsewhere the sub-map with the nearest centre does. Ends
  /// at the first static obstacle, or when all configurations of one sub-map have ended the ray.
  void events(double x_m, double y_m, double c, double s, double max_range_m, int current,
              std::vector<RayEvent>& events) const;

 private:
  struct Owner {
    std::int32_t submap;
    std::uint64_t mask;
    bool is_last;
  };
  RayWalker walker_;
  Grid<std::int32_t> first_owner_;  // place in owners_; -1: the static map
  std::vector<Owner> owners_;
  std::vector<std::uint64_t> all_;  // per sub-map: the mask of all its configurations
};

/// p(z) of one beam when sub-map s is in configuration k with probability belief[offset(s) + k],
/// independently of other sub-maps: the exact recursion of SPEC C4 over the events of its ray. Each
/// event counts with the probability that its configuration holds and no earlier event ended the
/// beam. fixed_submap >= 0: that one is known to be in fixed_patch. end_value: the value of a beam
/// that meets nothing. values[e] is what event e contributes. O(events^2).
[[nodiscard]] double mix_events(const std::vector<RayEvent>& events,
                                const std::vector<double>& values, double end_value,
                                const PatchStates& states, std::span<const float> belief,
                                int fixed_submap = -1, int fixed_patch = -1);

/// The sensor model of patch maps (SPEC C3 to C5). Without memory a particle's own configuration
/// holds in its sub-map and all are equally likely in others. With memory the weight of a particle
/// is the normalizer: its sub-map's configurations are mixed for the scan as a whole, those of
/// others beam by beam; and every sub-map that beams cross is learned.
class PatchBeamModel final : public SensorModel {
 public:
  explicit PatchBeamModel(std::shared_ptr<const patch::PatchMap> map,
                          const PatchBeamModelConfig& config = {});

  std::size_t log_likelihoods(const Scan& scan, double tempering, ParticleSet& particles,
                              std::span<double> log_likelihood, WorkerPool& pool) const override;
  [[nodiscard]] double tempering() const override { return config_.beam.tempering; }
  [[nodiscard]] double explained_share(const Scan& scan, const Pose2& map_from_robot,
                                       const ParticleSet& particles) const override;
  [[nodiscard]] const PatchStates* patch_states() const override { return &states_; }

 private:
  struct Scratch;
  double weigh_sampled(const ScanBeams& beams, const BeamMixture& mixture, double tempering,
                       const ParticleSet& particles, std::size_t i, Scratch& scratch) const;
  double weigh_remembered(const ScanBeams& beams, const BeamMixture& mixture, double tempering,
                          ParticleSet& particles, std::size_t i, Scratch& scratch) const;
  void cast(const Pose2& map_from_laser, const ScanBeams& beams, std::size_t beam, int current,
            const BeamMixture& mixture, Scratch& scratch) const;

  PatchBeamModelConfig config_;
  PatchStates states_;
  PatchRayCaster caster_;
};

}  // namespace strata::localization
