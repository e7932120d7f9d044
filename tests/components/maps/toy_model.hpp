// SPDX-License-Identifier: Apache-2.0
/// A map model that only tests know: the occupancy grid under another name.
#pragma once

#include <memory>
#include <string>

#include "components/maps/map_model.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/rays/ray_caster.hpp"

namespace strata::maps::test_room {

inline MapModelDescriptor toy_model() {
  using rays::RayCaster;
  MapModelDescriptor model;
  model.name = "toy";
  model.family = "grid";
  model.description = "a grid that only tests know";
  model.needs = {MapPart::kOccupancy};
  model.is_compared = true;
  model.make = [](const Maps& maps, const std::string& /*argument*/,
                  const patch_beams::PatchBeamModelConfig& config) {
    const auto caster = std::make_shared<const RayCaster>(maps.occupancy);
    MapModel made;
    made.sensor =
        std::make_shared<const localization::RangeProviderModel<RayCaster>>(caster, config.beam);
    made.best_prediction = [caster](const localization::ParticleSet&) -> RangeFunction {
      return [caster](const Pose2& laser, double bearing_rad) {
        return static_cast<double>(caster->expected_range_m(laser, bearing_rad));
      };
    };
    made.bytes = maps.occupancy.size();
    return made;
  };
  return model;
}

/// The built-in models and the toy.
inline MapModels with_toy() {
  MapModels models = map_models();
  models.add(toy_model());
  return models;
}

}  // namespace strata::maps::test_room
