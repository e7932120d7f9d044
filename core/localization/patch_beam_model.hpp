// SPDX-License-Identifier: Apache-2.0
/// Beams in a map of which some parts are in one of several configurations.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "core/localization/changing_beams.hpp"
#include "core/localization/laser_columns.hpp"
#include "core/localization/patch_ray_caster.hpp"
#include "core/localization/patch_states.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/localization/seen_boxes.hpp"
#include "core/localization/sensor_model.hpp"
#include "core/localization/submap_ratios.hpp"

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

/// The sensor model of patch maps (docs/theory/patch_localization.md, "Memory of sub-maps").
/// Without memory a particle's own configuration holds in its sub-map, all are alike in others.
/// With it the weight is the normalizer: its sub-map's configurations are mixed for the whole scan,
/// those of others beam by beam; and every sub-map that beams cross is learned.
class PatchBeamModel final : public SensorModel {
 public:
  explicit PatchBeamModel(std::shared_ptr<const patch::PatchMap> map,
                          const PatchBeamModelConfig& config = {});

  std::size_t log_likelihoods(const Scan& scan, const Weighing& weighing, ParticleSet& particles,
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
    std::size_t row = 0;     ///< of its sub-map's configurations in Scratch::said
    std::uint32_t particle = 0;
    std::uint32_t configurations = 0;  ///< how many; 0 without memory
  };
  /// A beam that may end at more.
  struct OtherBeam {
    std::size_t log = 0;
    std::size_t particle = 0;
    std::size_t event = 0;  ///< first of its places in Scratch::events
    std::size_t value = 0;  ///< ... in Scratch::value
    std::size_t events = 0;
    std::size_t met = 0;  ///< first of its places in Scratch::met
    std::size_t met_end = 0;
    bool is_once_each = false;  ///< it met no sub-map twice
  };
  /// A sub-map that such a beam met.
  struct MetSubmap {
    std::int32_t submap = -1;
    std::size_t row = 0;  ///< of its configurations in Scratch::said
  };
  /// The beliefs of one sub-map on their way; one entry a particle, `product` in rows of these for
  /// each configuration.
  struct BeliefUpdate {
    std::vector<double> product, sum, clamped;
  };
  /// Working memory of one chunk of particles. Particles count from its beginning.
  struct Scratch {
    LaserColumns lasers;
    SeenBoxes boxes;
    ChangingBeams changing;
    std::vector<double> box_share;  // probability that the cells of a box are there, as SeenBoxes
    std::vector<double> static_m;  // where beams end for certain; a row a beam, an entry a particle
    std::vector<std::int32_t> cells;
    std::vector<double> logs;        // the same rows: what they say
    std::vector<double> sums;        // of logs, of each particle
    std::vector<double> single_log;  // the same of the beams that mix_single() takes out of them
    // Of each pair: the nearer obstacle is there with probability share; what the beam then says.
    std::vector<Pair> pairs;
    std::vector<double> share, first, second, mixed;
    std::vector<OtherBeam> others;
    std::vector<RayEvent> events;
    std::vector<double> value;   // of the events of a beam, then of its end
    std::vector<MetSubmap> met;  // with memory: by each of the others
    SubmapRatios said;           // ln p(scan | m_s = k) less what the log-likelihood holds already
    BeliefUpdate update;
    std::vector<float> belief;
    std::vector<SubmapBelief> posterior;
  };
  /// What particles believe of all sub-maps: a row for each, or one for all.
  struct Beliefs {
    const float* rows = nullptr;
    std::size_t columns = 0;  ///< all
    std::size_t stride = 0;   ///< from one particle to the next; 0: one row for all
    [[nodiscard]] std::span<const float> of(std::size_t particle) const {
      return {rows + particle * stride, columns};
    }
  };
  void cast(const ScanScratch& scan, const ChunkStates& states, Scratch& scratch) const;
  void cast_one(const ScanScratch& scan, const Pose2& laser, int current, Scratch& scratch) const;
  class EventsInOrder;
  void list_beams(const Beliefs& beliefs, Scratch& scratch) const;
  void list_pair(const ChangingBeam& beam, const Beliefs& beliefs, Scratch& scratch) const;
  void list_other(const ChangingBeam& beam, Scratch& scratch) const;
  void share_boxes(const Beliefs& beliefs, const ChunkStates& states, Scratch& scratch) const;
  void mix_single(const ScanMixture& mixture, const Beliefs& beliefs, const ChunkStates& states,
                  Scratch& scratch) const;
  void mix_pairs(Scratch& scratch) const;
  void mix_others(const Beliefs& beliefs, const ChunkStates& states, Scratch& scratch) const;
  void mix_once_each(const OtherBeam& other, std::span<const RayEvent> events,
                     const Beliefs& beliefs, const ChunkStates& states, Scratch& scratch) const;
  void mix_any(const OtherBeam& other, std::span<const RayEvent> events, const Beliefs& beliefs,
               const ChunkStates& states, Scratch& scratch) const;
  void remember(double tempering, ParticleSet& particles, std::size_t begin, std::size_t end,
                std::span<double> log_likelihood, Scratch& scratch) const;
  void scale_ratios(double tempering, std::span<const std::int32_t> current,
                    std::span<double> log_likelihood, SubmapRatios& said,
                    std::vector<double>& largest) const;
  void update_beliefs(std::size_t place, std::size_t begin, std::size_t count, SubmapRatios& said,
                      ParticleSet& particles, BeliefUpdate& update) const;
  void write_ratios(std::size_t place, std::span<const std::int32_t> current, std::size_t begin,
                    SubmapRatios& said, ParticleSet& particles, BeliefUpdate& update) const;
  /// Those of particles from `begin` on.
  [[nodiscard]] Beliefs beliefs(const ParticleSet& particles, std::size_t begin) const;

  PatchBeamModelConfig config_;
  PatchStates states_;
  PatchRayCaster caster_;
  BeamMixture mixture_;  // its limit is set for every scan
  Lender<ScanScratch> scan_scratch_;
  Lender<Scratch> scratch_;
};

}  // namespace strata::localization
