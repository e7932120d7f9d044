// SPDX-License-Identifier: Apache-2.0
/// Beams in a map of which some parts are in one of several configurations.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "core/localization/patch_ray_caster.hpp"
#include "core/localization/patch_states.hpp"
#include "core/localization/range_provider_model.hpp"
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
  /// What a scan says, the same for all particles.
  struct ScanScratch {
    ScanBeams beams;
    ScanMixture mixture;
  };
  /// Working memory of one chunk of particles.
  struct Scratch {
    double heading_cosine = 1.0;  // of the laser
    double heading_sine = 0.0;
    std::vector<double> expected;  // per beam: range of the first cell that is ever an obstacle
    std::vector<std::int32_t> cells;
    std::vector<double> logs;
    std::vector<RayEvent> events;
    std::vector<double> values;
    double end_value = 0.0;
    std::vector<double> log_ratio;  // per column: ln p(scan | m_s = k) - ln p(scan | beliefs)
    std::vector<double> factor;
    std::vector<float> belief;
    std::vector<SubmapBelief> posterior;
  };
  void cast_all(const Pose2& laser, const ScanBeams& beams, Scratch& scratch) const;
  void find_events(const Pose2& laser, const ScanBeams& beams, std::size_t beam, int current,
                   const BeamMixture& mixture, Scratch& scratch) const;
  double weigh_sampled(const ScanScratch& scan, double tempering, const ParticleSet& particles,
                       std::size_t i, Scratch& scratch) const;
  double weigh_remembered(const ScanScratch& scan, double tempering, ParticleSet& particles,
                          std::size_t i, Scratch& scratch) const;
  void compare_configurations(std::span<const float> belief, double log_mixed,
                              Scratch& scratch) const;
  double own_mixture(std::span<const float> belief, int current, const Scratch& scratch) const;

  PatchBeamModelConfig config_;
  PatchStates states_;
  PatchRayCaster caster_;
  BeamMixture mixture_;  // its limit is set for every scan
  Lender<ScanScratch> scan_scratch_;
  Lender<Scratch> scratch_;
};

}  // namespace strata::localization
