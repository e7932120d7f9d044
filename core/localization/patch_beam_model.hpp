// SPDX-License-Identifier: Apache-2.0
/// Beams in a map of which some parts are in one of several configurations.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "core/localization/changing_beams.hpp"
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
  [[nodiscard]] Explanation explain(const Scan& scan, const Pose2& map_from_robot,
                                    const ParticleSet& particles) const override;
  [[nodiscard]] const PatchStates* patch_states() const override { return &states_; }

 private:
  /// What a scan says, the same for all particles.
  struct ScanScratch {
    ScanBeams beams;
    ScanMixture mixture;
  };
  /// A beam that ends at one of two places.
  struct Pair {
    std::size_t log = 0;     ///< place in Scratch::logs
    std::uint64_t near = 0;  ///< configurations that end it at the nearer one
    std::size_t ratios = 0;  ///< of its sub-map's configurations, first place in Scratch::ratio
    int configurations = 0;  ///< how many; 0 without memory
  };
  /// A beam that may end at more.
  struct OtherBeam {
    std::size_t log = 0;
    std::size_t particle = 0;
    std::size_t event = 0;  ///< first of its places in Scratch::events
    std::size_t value = 0;  ///< ... in Scratch::value
    std::size_t events = 0;
    std::size_t met = 0;  ///< first of its places in Scratch::met
  };
  /// A sub-map that beams met.
  struct Said {
    std::int32_t submap = -1;
    std::size_t ratios = 0;
  };
  /// Working memory of one chunk of particles.
  struct Scratch {
    std::vector<RayBox> chunk_boxes;  // near any particle
    std::vector<RayBox> boxes;        // near one
    std::vector<double> static_m;     // per beam: where it ends for certain
    std::vector<std::int32_t> cells;
    std::vector<double> logs;  // rows of one entry a beam
    ChangingBeams changing;
    // Of each pair: the nearer obstacle is there with probability share; what the beam then says.
    std::vector<Pair> pairs;
    std::vector<double> share, first, second, mixed;
    std::vector<OtherBeam> others;
    std::vector<RayEvent> events;
    std::vector<double> value;  // of the events of a beam, then of its end
    std::vector<Said> met;      // with memory: by each of the others
    std::vector<Said> said;     // by each particle
    std::vector<std::size_t> said_begins;
    std::vector<double> ratio;  // ln p(scan | m_s = k) - ln p(scan | beliefs)
    std::vector<float> belief;
    std::vector<SubmapBelief> posterior;
  };
  void find_boxes(const ScanBeams& beams, const ParticleSet& particles, std::size_t begin,
                  std::size_t end, Scratch& scratch) const;
  void cast(const ScanScratch& scan, const ParticleSet& particles, std::size_t begin,
            std::size_t end, Scratch& scratch) const;
  void list_beams(const ParticleSet& particles, std::size_t begin, std::size_t end,
                  Scratch& scratch) const;
  void list_pair(const ChangingBeam& beam, std::size_t log, std::span<const float> believed,
                 Scratch& scratch) const;
  void list_other(const ChangingBeam& beam, std::size_t log, std::size_t particle,
                  Scratch& scratch) const;
  void mix_pairs(Scratch& scratch) const;
  void mix_others(const ParticleSet& particles, Scratch& scratch) const;
  void remember(double tempering, ParticleSet& particles, std::size_t begin, std::size_t end,
                std::span<double> log_likelihood, Scratch& scratch) const;
  [[nodiscard]] std::size_t ratios(std::int32_t submap, Scratch& scratch) const;
  /// What particle i believes of all sub-maps.
  [[nodiscard]] std::span<const float> belief(const ParticleSet& particles, std::size_t i) const;

  PatchBeamModelConfig config_;
  PatchStates states_;
  PatchRayCaster caster_;
  BeamMixture mixture_;  // its limit is set for every scan
  Lender<ScanScratch> scan_scratch_;
  Lender<Scratch> scratch_;
};

}  // namespace strata::localization
