// SPDX-License-Identifier: Apache-2.0
/// `occupancy` and `filtered`: one grid, which stays as it was learned.
#include <memory>
#include <string>
#include <utility>

#include "components/maps/models/ranges.hpp"
#include "core/rays/ray_caster.hpp"

namespace strata::maps {
namespace {

using localization::ParticleSet;
using rays::RayCaster;

/// A grid map whose sensor model is made from its ray caster.
template <typename MakeSensor>
MapModel grid_model(const ReflectionGrid& map, MakeSensor&& make_sensor) {
  const auto caster = std::make_shared<const RayCaster>(map);
  MapModel model;
  model.sensor = make_sensor(caster);
  model.best_prediction = [ranges = ranges_of(caster)](const ParticleSet&) { return ranges; };
  model.bytes = map.size();
  model.resident_bytes = map.size() * kCasterBytes;
  return model;
}

MapModelDescriptor grid(const char* name, const char* description, MapPart part,
                        ReflectionGrid Maps::*map) {
  MapModelDescriptor model;
  model.name = name;
  model.family = "grid";
  model.description = description;
  model.needs = {part};
  model.is_compared = true;
  model.make = [map](const Maps& maps, const std::string& /*argument*/,
                     const patch_beams::PatchBeamModelConfig& config) {
    return grid_model(maps.*map, [&](const std::shared_ptr<const RayCaster>& caster) {
      return std::make_shared<const localization::RangeProviderModel<RayCaster>>(caster,
                                                                                 config.beam);
    });
  };
  model.make_likelihood_field = [map](const Maps& maps,
                                      const localization::LikelihoodFieldModelConfig& config) {
    return grid_model(maps.*map, [&](const std::shared_ptr<const RayCaster>& caster) {
      return std::make_shared<const localization::LikelihoodFieldModel>(maps.*map, config, caster);
    });
  };
  return model;
}

}  // namespace

void add_grid(MapModels& models) {
  models.add(grid("occupancy", "a grid of all beams", MapPart::kOccupancy, &Maps::occupancy));
  models.add(grid("filtered", "a grid of the beams that hit what stands still, after EM",
                  MapPart::kFiltered, &Maps::filtered));
}

}  // namespace strata::maps
