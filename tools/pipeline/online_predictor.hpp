// SPDX-License-Identifier: Apache-2.0
/// The predictions of one map model that learns at the true poses as it would on the robot: what
/// it expects, and the grid to plan in.
#pragma once

#include <memory>

#include "components/maps/map_model.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "core/scan/scan.hpp"

namespace strata::pipeline {

class OnlinePredictor {
 public:
  virtual ~OnlinePredictor() = default;
  /// Goes to a pose; configurations may have changed since the last stamp.
  virtual void go_to(const Pose2& map_from_robot, Stamp stamp) = 0;
  /// The single best prediction from what is known now. Valid until the next call.
  [[nodiscard]] virtual maps::RangeFunction expected_range() = 0;
  virtual void learn(const Observation& observation, const Pose2& map_from_robot) = 0;
  /// The grid to plan in, as it is known now: the same pointer as long as it is the same; null for
  /// a map that lies in another frame. Timescale levels: cells that most levels that know them
  /// expect to be occupied.
  [[nodiscard]] virtual std::shared_ptr<const ReflectionGrid> map() = 0;
};

/// Grids stay as learned, patch models follow by their beliefs, and timescale memories (a copy) go
/// on learning, where the model does. model: made of maps, which must stay. sensor: as for
/// make_map_model.
[[nodiscard]] std::unique_ptr<OnlinePredictor> make_online_predictor(
    const maps::Maps& maps, const maps::MapModel& model,
    const patch_beams::PatchBeamModelConfig& sensor);

}  // namespace strata::pipeline
