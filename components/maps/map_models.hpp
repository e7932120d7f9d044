// SPDX-License-Identifier: Apache-2.0
/// Which map models there are. Each describes itself once: `localize`, `compare`, the localizer,
/// their help and the reference page read it from here.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "components/maps/maps_folder.hpp"
#include "core/localization/likelihood_field_model.hpp"
#include "core/patch_beams/patch_beam_model.hpp"

namespace strata::maps {

struct MapModel;

/// What changes in a model while a robot is localized with it.
enum class MapLearning {
  kNothing,
  kSubmapStates,  ///< what is believed of each sub-map
  kLevelWeights,  ///< how far each timescale level is believed
  kMemory,        ///< the timescale memory takes in the scans, too
  kCells,         ///< what is believed of each cell
};

struct MapModelDescriptor {
  /// What --model names: "patch_paper".
  std::string name;
  /// Of a model for each of something that the maps hold, such as "LEVEL": the model is then named
  /// by `name` and one of `arguments` behind it.
  std::string argument;
  std::string family;       ///< "patch"; for people
  std::string description;  ///< one line, for help and pages
  std::vector<MapPart> needs;
  MapLearning learns = MapLearning::kNothing;
  bool is_compared = false;  ///< `compare` takes it when no models are named
  /// The model that is made of its map once that is the map of a MAPS folder of its own; empty:
  /// this one.
  std::string in_own_folder;

  /// Of maps that have all that it needs. argument: as the model's name gives it. The names of the
  /// model, and itself, are filled in by who calls this.
  std::function<MapModel(const Maps& maps, const std::string& argument,
                         const patch_beams::PatchBeamModelConfig& config)>
      make;
  /// What `argument` can be in these maps; as long as there is an argument.
  std::function<std::vector<std::string>(const Maps& maps)> arguments;
  /// The same map with the sensor model of end points; empty: it needs beams that are traced.
  std::function<MapModel(const Maps& maps, const localization::LikelihoodFieldModelConfig& config)>
      make_likelihood_field;

  /// "timescale_LEVEL"; without argument the name.
  [[nodiscard]] std::string shown_name() const { return name + argument; }
  [[nodiscard]] bool has_likelihood_field() const { return bool(make_likelihood_field); }
  [[nodiscard]] bool needs_part(MapPart part) const;
  [[nodiscard]] bool is_made_of(const Maps& maps) const;
  /// All that it needs is learned from scans.
  [[nodiscard]] bool is_learned() const;
  /// ... is held by a MAPS folder.
  [[nodiscard]] bool is_in_folder() const;
  /// ... can come over topics, from a robot that goes on mapping.
  [[nodiscard]] bool follows_topics() const;
};

/// The grid, or the sub-maps, that a model of these maps shows; null: it is none, or has none.
[[nodiscard]] const ReflectionGrid* grid_of(const MapModelDescriptor& model, const Maps& maps);
[[nodiscard]] const patch::PatchMap* patches_of(const MapModelDescriptor& model, const Maps& maps);

/// "a, b or c".
[[nodiscard]] std::string join_names(const std::vector<std::string>& names, const char* last);

class MapModels {
 public:
  using Pointer = std::shared_ptr<const MapModelDescriptor>;

  /// Throws ConfigError for a name that is taken, and where the name, the family, a description of
  /// one line, what it needs or how it is made is missing.
  void add(MapModelDescriptor model);

  /// In the order of add().
  [[nodiscard]] const std::vector<Pointer>& all() const { return models_; }
  /// By what --model says; null where there is none.
  [[nodiscard]] Pointer find(const std::string& name) const;
  /// ... throws ConfigError where there is none.
  [[nodiscard]] Pointer at(const std::string& name) const;
  /// shown_name() of each that `is_one_of`.
  [[nodiscard]] std::vector<std::string> names(
      const std::function<bool(const MapModelDescriptor&)>& is_one_of) const;
  /// What `compare` takes when no models are named.
  [[nodiscard]] std::vector<std::string> compared() const;
  /// A line for each that `is_one_of`: name and description.
  [[nodiscard]] std::string help(
      const std::function<bool(const MapModelDescriptor&)>& is_one_of) const;

 private:
  std::vector<Pointer> models_;
};

/// Those of components/maps/models, which components/maps/CMakeLists.txt lists.
[[nodiscard]] const MapModels& map_models();

/// What the settings `model` and `sensor_model` say of themselves; as long as the program lives.
[[nodiscard]] const char* model_doc();
[[nodiscard]] const char* sensor_model_doc();

}  // namespace strata::maps
