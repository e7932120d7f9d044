// SPDX-License-Identifier: Apache-2.0
/// Beams in a map of which some parts are in one of several configurations.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/localization/inlier_shares.hpp"
#include "core/localization/patch_states.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/localization/sensor_model.hpp"
#include "core/patch/patch_map.hpp"
#include "core/patch_beams/patch_ray_caster.hpp"
#include "core/rays/beam_mixture.hpp"
#include "core/scan/scan.hpp"

namespace strata::patch_beams {

struct PatchBeamModelConfig {
  localization::BeamModelConfig beam;
  localization::PatchStatesConfig states;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("beam", c.beam, "the beam model, the same as for other maps");
    v.group("states", c.states, "how configurations are remembered and forgotten");
  }
};

/// The sensor model of patch maps (docs/theory/patch_localization.md, "Memory of sub-maps").
/// Without memory a particle's own configuration holds in its sub-map, all are alike in others.
/// With it the weight is the normalizer: its sub-map's configurations are mixed for the whole scan,
/// those of others beam by beam; and every sub-map that beams cross is learned. A chunk of
/// particles goes through the stages of docs/theory/patch_beams.md, "Pipeline".
class PatchBeamModel final : public localization::SensorModel {
 public:
  explicit PatchBeamModel(std::shared_ptr<const patch::PatchMap> map,
                          const PatchBeamModelConfig& config = {});
  ~PatchBeamModel() override;

  std::size_t log_likelihoods(const Scan& scan, const localization::Weighing& weighing,
                              localization::ParticleSet& particles,
                              std::span<double> log_likelihood, WorkerPool& pool) const override;
  [[nodiscard]] double tempering() const override { return config_.beam.tempering; }
  [[nodiscard]] localization::InlierShares inlier_shares(
      const Scan& scan, const Pose2& map_from_robot,
      const localization::ParticleSet& particles) const override;
  [[nodiscard]] localization::InlierShares inlier_shares_given(
      const std::vector<localization::SubmapBelief>& posterior, const Scan& scan,
      const Pose2& map_from_robot, const localization::ParticleSet& particles) const override;
  /// The nearest obstacle of any configuration counts.
  void find_unjudged(const Scan& scan, const Pose2& map_from_robot,
                     std::vector<std::uint8_t>& is_unjudged) const override;
  [[nodiscard]] const localization::PatchStates* patch_states() const override { return &states_; }

 private:
  struct Lenders;

  PatchBeamModelConfig config_;
  localization::PatchStates states_;
  PatchRayCaster caster_;
  rays::BeamMixture mixture_;  // its limit is set for every scan
  std::unique_ptr<const Lenders> lenders_;
};

}  // namespace strata::patch_beams
