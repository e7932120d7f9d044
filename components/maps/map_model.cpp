// SPDX-License-Identifier: Apache-2.0
#include "components/maps/map_model.hpp"

#include <utility>

#include "core/base/error.hpp"

namespace strata::maps {
namespace {

void require_parts(const MapModelDescriptor& descriptor, const Maps& maps,
                   const std::string& name) {
  if (descriptor.is_made_of(maps)) return;
  if (!descriptor.is_learned()) {
    throw InputError("model " + name, "needs a map that was not learned here",
                     "give its YAML file with --map");
  }
  throw InputError("model " + name, "is not in these maps", "learn it first, or choose another");
}

MapModel named(MapModel model, const std::string& name, MapModels::Pointer descriptor) {
  model.name = name;
  model.descriptor = std::move(descriptor);
  return model;
}

MapModel make(const Maps& maps, const std::string& name, const MapModels::Pointer& descriptor,
              const patch_beams::PatchBeamModelConfig& config) {
  require_parts(*descriptor, maps, name);
  const std::string argument = name.substr(descriptor->name.size());
  return named(descriptor->make(maps, argument, config), name, descriptor);
}

}  // namespace

std::vector<std::string> model_names(const Maps& maps, const MapModels& models) {
  std::vector<std::string> names;
  for (const MapModels::Pointer& model : models.all()) {
    if (!model->is_made_of(maps)) continue;
    if (model->argument.empty()) {
      names.push_back(model->name);
      continue;
    }
    for (const std::string& argument : model->arguments(maps)) {
      names.push_back(model->name + argument);
    }
  }
  return names;
}

MapModel make_map_model(const Maps& maps, const std::string& name,
                        const patch_beams::PatchBeamModelConfig& config, const MapModels& models) {
  const MapModels::Pointer descriptor = models.find(name);
  if (!descriptor) {
    throw ConfigError("model " + name, "is unknown",
                      "choose one of " + join_names(model_names(maps, models), ", "));
  }
  return make(maps, name, descriptor, config);
}

MapModel make_map_model(const Maps& maps, const MapModel& like,
                        const patch_beams::PatchBeamModelConfig& config) {
  return make(maps, like.name, like.descriptor, config);
}

MapModel make_likelihood_field_model(const Maps& maps, const std::string& name,
                                     const localization::LikelihoodFieldModelConfig& config,
                                     const MapModels& models) {
  const MapModels::Pointer descriptor = models.find(name);
  if (!descriptor || !descriptor->has_likelihood_field()) {
    const auto names = models.names(&MapModelDescriptor::has_likelihood_field);
    throw ConfigError("model " + name, "has no likelihood field",
                      "choose " + join_names(names, " or ") + ", or sensor_model=beam");
  }
  require_parts(*descriptor, maps, name);
  return named(descriptor->make_likelihood_field(maps, config), name, descriptor);
}

}  // namespace strata::maps
