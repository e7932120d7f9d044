// SPDX-License-Identifier: Apache-2.0
#include "core/cells/cell_model.hpp"

#include <utility>

namespace strata::cells {
namespace {

std::shared_ptr<ShownRanges> ranges_in(const ReflectionGrid& grid) {
  auto ranges = std::make_shared<ShownRanges>();
  ranges->show(grid);
  return ranges;
}

/// As map_model.hpp counts a ray caster: a distance, and whether the cell is known.
constexpr std::size_t kRayBytes = sizeof(float) + 1;

}  // namespace

CellModel::CellModel(std::shared_ptr<const CellMap> map, const localization::BeamModelConfig& beam,
                     const CellConfig& config)
    : map_(std::move(map)),
      beam_(beam),
      config_(config),
      ranges_(ranges_in(usual_grid(*map_))),
      rays_(ranges_, beam) {}

std::unique_ptr<localization::SensorModel> CellModel::for_one_run() const {
  auto own = std::make_unique<CellModel>(map_, beam_, config_);
  own->beliefs_.emplace(*map_, config_);
  return own;
}

void CellModel::learn(const Observation& observation, const Pose2Gaussian& map_from_robot,
                      const localization::PoseTrust& trust) {
  if (!beliefs_ || trust.is_in_doubt || trust.score < config_.min_score) return;
  const Scan& scan = observation.scan;
  beliefs_->observe(scan, map_from_robot.mean * scan.robot_from_laser);
  if (beliefs_->refresh(scan.stamp)) ranges_->show(beliefs_->grid());
}

std::size_t CellModel::bytes() const { return map_->known * sizeof(CellState); }

std::size_t CellModel::resident_bytes() const {
  const std::size_t dense = map_->cells.size() * (sizeof(float) + kRayBytes);
  // Beliefs hold a cell's state and as much again of what they keep beside it.
  return map_->cells.allocated_bytes() * 3 + dense;
}

}  // namespace strata::cells
