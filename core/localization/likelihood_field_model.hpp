// SPDX-License-Identifier: Apache-2.0
/// The fast sensor model: how far each end point lies from the nearest obstacle.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/grid/likelihood_field.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/localization/likelihood_field_kernel.hpp"
#include "core/localization/object_pool.hpp"
#include "core/localization/sensor_model.hpp"
#include "core/rays/ray_caster.hpp"

namespace strata::localization {

struct LikelihoodFieldModelConfig {
  LikelihoodFieldConfig field;
  int max_beams = 180;
  double tempering = 8.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("field", c.field, "likelihood of an end point by its distance to the map");
    v.field("max_beams", c.max_beams,
            {.doc = "hits in use, spread evenly over the scan, or over those of several scanners "
                    "that are weighed together; 0: all",
             .unit = "beams",
             .min = 0});
    v.field("tempering", c.tempering,
            {.doc = "the log-likelihood is divided by this, as beams are not independent",
             .unit = "1",
             .min = 0.1});
  }
};

/// [thrun2005probabilistic, table 6.3]; docs/theory/patch_localization.md, "Likelihood field". It
/// cannot punish beams that cross a mapped closed door: for speed, not for telling configurations
/// apart. Obstacles: is_occupied. Tabulated in 65,535 steps from its least value to 0, so the sum
/// over 180 beams is within 0.005 nats of the exact one.
class LikelihoodFieldModel final : public SensorModel {
 public:
  /// caster: of the same map, when there is one already; null: one is made.
  explicit LikelihoodFieldModel(const ReflectionGrid& map,
                                const LikelihoodFieldModelConfig& config = {},
                                std::shared_ptr<const rays::RayCaster> caster = nullptr);

  std::size_t log_likelihoods(const Scan& scan, const Weighing& weighing, ParticleSet& particles,
                              std::span<double> log_likelihood, WorkerPool& pool) const override;
  [[nodiscard]] double tempering() const override { return config_.tempering; }
  /// A hit is an inlier within 3 hit_stddev of an obstacle, and met within as much along its ray:
  /// the field does not tell what lies before it. Asks 60 hits at most.
  [[nodiscard]] InlierShares inlier_shares(const Scan& scan, const Pose2& map_from_robot,
                                           const ParticleSet& particles) const override;
  void find_unjudged(const Scan& scan, const Pose2& map_from_robot,
                     std::vector<std::uint8_t>& is_unjudged) const override;

 private:
  /// End points in the robot frame, in cells.
  struct Points {
    std::vector<std::uint32_t> beams;
    std::vector<float> x;
    std::vector<float> y;
  };
  /// Of at most that many hits, spread evenly; 0: of all.
  void find_points(const Scan& scan, std::size_t most, Points& points) const;

  LikelihoodFieldModelConfig config_;
  LikelihoodField field_;
  std::shared_ptr<const rays::RayCaster> caster_;
  std::vector<std::uint16_t> bordered_;  // -ln p in steps of quantum_
  FieldTable table_;
  double quantum_ = 1.0;      // nats
  float inlier_from_ = 0.0F;  // ln p at 3 standard deviations
  ObjectPool<Points> points_;
};

}  // namespace strata::localization
