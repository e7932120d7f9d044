// SPDX-License-Identifier: Apache-2.0
/// The beam model for any map that can say how far a beam should go.
#pragma once

#include <cmath>
#include <concepts>
#include <memory>
#include <utility>

#include "core/base/config.hpp"
#include "core/localization/beam_mixture.hpp"
#include "core/localization/ray_caster.hpp"
#include "core/localization/scan_beams.hpp"
#include "core/localization/sensor_model.hpp"

namespace strata::localization {

/// Whatever predicts ranges: metres along the beam from a laser at that pose, +infinity for no
/// obstacle. Called from several threads at once.
template <typename T>
concept RangeProvider = requires(const T& provider, const Pose2& map_from_laser) {
  { provider.expected_range_m(map_from_laser, 0.0) } -> std::convertible_to<double>;
};

struct BeamModelConfig {
  BeamMixtureConfig mixture;
  BeamSelectionConfig beams;
  double tempering = 2.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("mixture", c.mixture, "what a beam measures given its expected range");
    v.group("beams", c.beams, "which beams are in use");
    v.field("tempering", c.tempering,
            {.doc = "the log-likelihood is divided by this, as beams are not independent",
             .unit = "1",
             .min = 0.1});
  }
};

/// ln p(z | x) = 1/tau sum over beams ln p(z_n | expected range). Every map model that localizes
/// with it has the same mixture, beams and temperature; only the provider differs (SPEC F).
template <RangeProvider Provider>
class RangeProviderModel final : public SensorModel {
 public:
  explicit RangeProviderModel(std::shared_ptr<const Provider> provider,
                              const BeamModelConfig& config = {})
      : provider_(std::move(provider)), config_(config) {
    require_valid(config, "beam_model");
  }

  std::size_t log_likelihoods(const Scan& scan, double tempering, ParticleSet& particles,
                              std::span<double> log_likelihood, WorkerPool& pool) const override {
    const ScanBeams beams = select_beams(scan, config_.beams);
    const BeamMixture mixture(config_.mixture, beams.r_max_m);
    constexpr std::size_t kChunk = 64;
    pool.for_chunks(
        particles.size(), kChunk, [&](std::size_t begin, std::size_t end, std::size_t /*chunk*/) {
          for (std::size_t i = begin; i < end; ++i) {
            const Pose2 laser = particles.pose(i) * beams.robot_from_laser;
            double sum = 0.0;
            for (std::size_t k = 0; k < beams.size(); ++k) {
              const double expected = provider_->expected_range_m(laser, beams.bearing_rad[k]);
              sum += std::log(mixture.likelihood(beams.is_hit[k] != 0, beams.range_m[k], expected));
            }
            log_likelihood[i] = sum / tempering;
          }
        });
    return beams.size();
  }

  [[nodiscard]] double tempering() const override { return config_.tempering; }

  [[nodiscard]] double explained_share(const Scan& scan, const Pose2& map_from_robot,
                                       const ParticleSet& /*particles*/) const override {
    const ScanBeams beams = select_beams(scan, config_.beams);
    if (beams.size() == 0) return 1.0;
    const BeamMixture mixture(config_.mixture, beams.r_max_m);
    const Pose2 laser = map_from_robot * beams.robot_from_laser;
    std::size_t explained = 0;
    for (std::size_t k = 0; k < beams.size(); ++k) {
      const double expected = provider_->expected_range_m(laser, beams.bearing_rad[k]);
      if (mixture.explains(beams.is_hit[k] != 0, beams.range_m[k], expected)) ++explained;
    }
    return static_cast<double>(explained) / static_cast<double>(beams.size());
  }

 private:
  std::shared_ptr<const Provider> provider_;
  BeamModelConfig config_;
};

/// Ray casting in one map: occupied means is_occupied, unknown is transparent.
using GridBeamModel = RangeProviderModel<RayCaster>;

[[nodiscard]] inline std::shared_ptr<const GridBeamModel> make_grid_beam_model(
    const ReflectionGrid& map, const BeamModelConfig& config = {}) {
  return std::make_shared<const GridBeamModel>(std::make_shared<const RayCaster>(map), config);
}

}  // namespace strata::localization
