// SPDX-License-Identifier: Apache-2.0
/// Timescale levels as sensor models.
#pragma once

#include <memory>
#include <utility>

#include "core/localization/range_provider_model.hpp"
#include "memory/nodes/node_map.hpp"

namespace strata::maps {

/// One level of a node map as a provider of expected ranges; where the level knows nothing, nothing
/// is expected, as in the unknown cells of a grid.
class LevelRanges {
 public:
  LevelRanges(std::shared_ptr<const memory::NodeMap> map, int level)
      : map_(std::move(map)), level_(level) {}
  [[nodiscard]] double expected_range_m(const Pose2& map_from_laser, double bearing_rad) const;

 private:
  std::shared_ptr<const memory::NodeMap> map_;
  int level_;
};

/// All levels at once: a beam's likelihood is the mean over the levels, each as likely as the
/// others. (SPEC D6 lets the weights follow how well each level explains the scans; they are even
/// here, so that the model stays without hidden state.)
class LevelMixtureModel final : public localization::SensorModel {
 public:
  LevelMixtureModel(std::shared_ptr<const memory::NodeMap> map,
                    const localization::BeamModelConfig& config);

  std::size_t log_likelihoods(const Scan& scan, double tempering,
                              localization::ParticleSet& particles,
                              std::span<double> log_likelihood, WorkerPool& pool) const override;
  [[nodiscard]] double tempering() const override { return config_.tempering; }
  [[nodiscard]] double explained_share(const Scan& scan, const Pose2& map_from_robot,
                                       const localization::ParticleSet& particles) const override;

 private:
  std::vector<LevelRanges> levels_;
  localization::BeamModelConfig config_;
};

}  // namespace strata::maps
