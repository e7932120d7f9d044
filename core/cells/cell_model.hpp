// SPDX-License-Identifier: Apache-2.0
/// Cells with chains of their own as a sensor model.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/cells/cell_beliefs.hpp"
#include "core/cells/cell_map.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/localization/sensor_model.hpp"
#include "core/rays/ray_caster.hpp"

namespace strata::cells {

/// Ranges in the grid that is shown now.
class ShownRanges {
 public:
  void show(const ReflectionGrid& grid) { caster_ = rays::RayCaster(grid); }
  [[nodiscard]] double expected_range_m(const Pose2& map_from_laser, double bearing_rad) const {
    return caster_.expected_range_m(map_from_laser, bearing_rad);
  }
  void expected_ranges_m(const rays::BeamBundle& bundle, double* range_m,
                         std::int32_t* cell) const {
    caster_.expected_ranges_m(bundle, range_m, cell);
  }
  [[nodiscard]] rays::RayTable table() const { return caster_.table(); }
  [[nodiscard]] double max_range_m() const { return caster_.max_range_m(); }
  [[nodiscard]] bool knows(const Eigen::Vector2d& point_m) const { return caster_.knows(point_m); }
  [[nodiscard]] bool is_near_surface(const Eigen::Vector2d& point_m, double distance_m) const {
    return caster_.is_near_surface(point_m, distance_m);
  }

 private:
  rays::RayCaster caster_;
};

/// The beam model of the grid maps in the cells that are probably occupied now. A copy for one run
/// follows the scans; the model itself, and a copy before its first scan, has what is usual.
class CellModel final : public localization::SensorModel {
 public:
  CellModel(std::shared_ptr<const CellMap> map, const localization::BeamModelConfig& beam,
            const CellConfig& config = {});

  std::size_t log_likelihoods(const Scan& scan, const localization::Weighing& weighing,
                              localization::ParticleSet& particles,
                              std::span<double> log_likelihood, WorkerPool& pool) const override {
    return rays_.log_likelihoods(scan, weighing, particles, log_likelihood, pool);
  }
  [[nodiscard]] double tempering() const override { return rays_.tempering(); }
  [[nodiscard]] localization::InlierShares inlier_shares(
      const Scan& scan, const Pose2& map_from_robot,
      const localization::ParticleSet& particles) const override {
    return rays_.inlier_shares(scan, map_from_robot, particles);
  }
  void find_unjudged(const Scan& scan, const Pose2& map_from_robot,
                     std::vector<std::uint8_t>& is_unjudged) const override {
    rays_.find_unjudged(scan, map_from_robot, is_unjudged);
  }
  [[nodiscard]] std::unique_ptr<SensorModel> for_one_run() const override;
  /// Of poses in doubt, or of a score below config.min_score, nothing is learned.
  void learn(const Observation& observation, const Pose2Gaussian& map_from_robot,
             const localization::PoseTrust& trust) override;

  [[nodiscard]] const std::shared_ptr<ShownRanges>& ranges() const { return ranges_; }
  [[nodiscard]] std::size_t bytes() const;           ///< of the chains
  [[nodiscard]] std::size_t resident_bytes() const;  ///< of them, a run's beliefs and its rays

 private:
  std::shared_ptr<const CellMap> map_;
  localization::BeamModelConfig beam_;
  CellConfig config_;
  std::shared_ptr<ShownRanges> ranges_;
  localization::RangeProviderModel<ShownRanges> rays_;
  std::optional<CellBeliefs> beliefs_;  ///< of a copy for one run
};

}  // namespace strata::cells
