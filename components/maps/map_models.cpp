// SPDX-License-Identifier: Apache-2.0
#include "components/maps/map_models.hpp"

#include <algorithm>
#include <utility>

#include "core/base/error.hpp"

namespace strata::maps {
namespace {

bool all_parts(const MapModelDescriptor& model, bool MapPartInfo::*is_so) {
  return std::all_of(model.needs.begin(), model.needs.end(),
                     [&](MapPart part) { return info_of(part).*is_so; });
}

/// Throws where something is missing without which nobody could use it.
void require_whole(const MapModelDescriptor& model) {
  const auto require = [&](bool is_there, const char* what, const char* remedy) {
    if (!is_there) throw ConfigError("map model '" + model.shown_name() + "'", what, remedy);
  };
  require(!model.name.empty(), "has no name", "say what --model calls it");
  require(!model.family.empty(), "has no family", "say what kind of map it is");
  require(!model.description.empty() && model.description.find('\n') == std::string::npos,
          "has no description of one line", "say for help and pages what it is");
  require(!model.needs.empty(), "needs no part of the maps", "say what it is made of");
  require(static_cast<bool>(model.make), "cannot be made", "give it a function `make`");
  require(model.argument.empty() == !model.arguments,
          "has an argument without arguments, or the other way round", "give both or none");
}

}  // namespace

bool MapModelDescriptor::needs_part(MapPart part) const {
  return std::find(needs.begin(), needs.end(), part) != needs.end();
}

bool MapModelDescriptor::is_made_of(const Maps& maps) const {
  return std::all_of(needs.begin(), needs.end(), [&](MapPart part) { return has(maps, part); });
}

bool MapModelDescriptor::is_learned() const { return all_parts(*this, &MapPartInfo::is_learned); }

bool MapModelDescriptor::is_in_folder() const {
  return all_parts(*this, &MapPartInfo::is_in_folder);
}

bool MapModelDescriptor::follows_topics() const {
  return std::all_of(needs.begin(), needs.end(),
                     [](MapPart part) { return info_of(part).message != nullptr; });
}

const ReflectionGrid* grid_of(const MapModelDescriptor& model, const Maps& maps) {
  if (model.needs_part(MapPart::kOccupancy)) return &maps.occupancy;
  if (model.needs_part(MapPart::kFiltered)) return &maps.filtered;
  return nullptr;
}

const patch::PatchMap* patches_of(const MapModelDescriptor& model, const Maps& maps) {
  const auto* patches = model.needs_part(MapPart::kPlacePatches) ? &maps.place_patches
                        : model.needs_part(MapPart::kPatches)    ? &maps.patches
                                                                 : nullptr;
  return patches != nullptr && *patches ? &**patches : nullptr;
}

std::string join_names(const std::vector<std::string>& names, const char* last) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? last : ", ";
    text += names[i];
  }
  return text;
}

void MapModels::add(MapModelDescriptor model) {
  require_whole(model);
  const bool is_taken = std::any_of(models_.begin(), models_.end(), [&](const Pointer& other) {
    return other->name == model.name || other->shown_name() == model.shown_name();
  });
  if (is_taken) {
    throw ConfigError("map model '" + model.shown_name() + "'", "is there already",
                      "give it another name");
  }
  models_.push_back(std::make_shared<const MapModelDescriptor>(std::move(model)));
}

MapModels::Pointer MapModels::find(const std::string& name) const {
  Pointer found;
  for (const Pointer& model : models_) {
    if (model->argument.empty()) {
      if (model->name == name) return model;
    } else if (name.size() > model->name.size() && name.starts_with(model->name)) {
      if (!found || model->name.size() > found->name.size()) found = model;
    }
  }
  return found;
}

MapModels::Pointer MapModels::at(const std::string& name) const {
  Pointer model = find(name);
  if (model) return model;
  throw ConfigError("model " + name, "is unknown",
                    "choose one of " + join_names(names([](const auto&) { return true; }), ", "));
}

std::vector<std::string> MapModels::names(
    const std::function<bool(const MapModelDescriptor&)>& is_one_of) const {
  std::vector<std::string> names;
  for (const Pointer& model : models_) {
    if (is_one_of(*model)) names.push_back(model->shown_name());
  }
  return names;
}

std::vector<std::string> MapModels::compared() const {
  return names(&MapModelDescriptor::is_compared);
}

std::string MapModels::help(const std::function<bool(const MapModelDescriptor&)>& is_one_of) const {
  std::string text;
  for (const Pointer& model : models_) {
    if (!is_one_of(*model)) continue;
    text += (text.empty() ? "" : "\n") + model->shown_name() + ": " + model->description;
  }
  return text;
}

const char* model_doc() {
  static const std::string text =
      join_names(map_models().names(&MapModelDescriptor::is_in_folder), " or ");
  return text.c_str();
}

const char* sensor_model_doc() {
  static const std::string text =
      "trace each beam, or look up its end point: faster, for " +
      join_names(map_models().names(&MapModelDescriptor::has_likelihood_field), " and ") + " only";
  return text.c_str();
}

}  // namespace strata::maps
