// SPDX-License-Identifier: Apache-2.0
/// The map models that a robot can be localized with, made from one MAPS folder: only what range a
/// beam is expected to measure differs between them (SPEC F).
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "components/maps/maps_folder.hpp"
#include "core/localization/patch_beam_model.hpp"
#include "core/localization/sensor_model.hpp"

namespace strata::maps {

/// Metres that a beam from a laser at that pose is expected to go; +infinity for no obstacle.
using RangeFunction = std::function<double(const Pose2& map_from_laser, double bearing_rad)>;

struct MapModel {
  std::string name;
  std::shared_ptr<const localization::SensorModel> sensor;
  /// The single best prediction, given what the particles believe of the sub-maps.
  std::function<RangeFunction(const localization::ParticleSet&)> best_prediction;
  /// A byte per cell of each grid, as map_server stores them; the state of the timescale levels.
  std::size_t bytes = 0;
};

/// Names that make_map_model accepts for these maps: occupancy, filtered, patch, patch_paper,
/// patch_shared, patch_per_particle, timescale, timescale_mixture, timescale_LEVEL.
[[nodiscard]] std::vector<std::string> model_names(const Maps& maps);

/// `patch` has the memory that `config` names, patch_paper none; `timescale` is timescale_mixture.
/// Timescale levels know nothing beyond their outermost bin, so for them readings from there on
/// count as no return. Throws ConfigError for a name that is unknown, and InputError for one whose
/// map was not learned.
[[nodiscard]] MapModel make_map_model(const Maps& maps, const std::string& name,
                                      const localization::PatchBeamModelConfig& config);

}  // namespace strata::maps
