// SPDX-License-Identifier: Apache-2.0
/// The map models that a robot can be localized with, made from one MAPS folder: only the range
/// that a beam is expected to measure differs (docs/theory/evaluation.md, "Same filter").
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "components/maps/map_models.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/base/config.hpp"
#include "core/localization/likelihood_field_model.hpp"
#include "core/localization/sensor_model.hpp"
#include "core/patch_beams/patch_beam_model.hpp"

namespace strata::maps {

/// Metres that a beam from a laser at that pose is expected to go; +infinity for no obstacle.
using RangeFunction = std::function<double(const Pose2& map_from_laser, double bearing_rad)>;

struct MapModel {
  std::string name;
  MapModels::Pointer descriptor;
  std::shared_ptr<const localization::SensorModel> sensor;
  /// The single best prediction, given what the particles believe of the sub-maps.
  std::function<RangeFunction(const localization::ParticleSet&)> best_prediction;
  /// A byte per cell of each grid, as map_server stores them; the state of the timescale levels.
  std::size_t bytes = 0;
  /// What the map takes in memory while localizing: grids, the distances that rays skip by, counts
  /// of configurations; the timescale memory and what was decoded from it.
  std::size_t resident_bytes = 0;
};

/// Names that make_map_model accepts for these maps, in the order of the registry.
[[nodiscard]] std::vector<std::string> model_names(const Maps& maps,
                                                   const MapModels& models = map_models());

/// Throws ConfigError for a name that is unknown, and InputError for one whose map was not learned.
[[nodiscard]] MapModel make_map_model(const Maps& maps, const std::string& name,
                                      const patch_beams::PatchBeamModelConfig& config,
                                      const MapModels& models = map_models());

/// The same model of other maps. Throws as make_map_model.
[[nodiscard]] MapModel make_map_model(const Maps& maps, const MapModel& like,
                                      const patch_beams::PatchBeamModelConfig& config);

/// What a scan is compared with: ranges along traced beams, or distances about its end points.
enum class SensorModelKind { kBeam, kLikelihoodField };

/// The fast model of end points, of models that have one. best_prediction is that of the beam
/// model. Throws as make_map_model.
[[nodiscard]] MapModel make_likelihood_field_model(
    const Maps& maps, const std::string& name,
    const localization::LikelihoodFieldModelConfig& config, const MapModels& models = map_models());

}  // namespace strata::maps

template <>
struct strata::EnumNames<strata::maps::SensorModelKind> {
  static constexpr std::array<std::pair<strata::maps::SensorModelKind, const char*>, 2> values{
      {{strata::maps::SensorModelKind::kBeam, "beam"},
       {strata::maps::SensorModelKind::kLikelihoodField, "likelihood_field"}}};
};
