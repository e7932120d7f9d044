// SPDX-License-Identifier: Apache-2.0
/// `patch` and its kin: sub-maps with configurations, by what is remembered of them.
#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/maps/models/ranges.hpp"
#include "core/rays/ray_caster.hpp"

namespace strata::maps {
namespace {

using localization::ParticleSet;
using localization::PatchMemory;
using patch_beams::PatchBeamModelConfig;
using rays::RayCaster;

/// The likeliest configuration of each sub-map, from the first particle's or the shared belief.
std::vector<int> believed(const localization::PatchStates& states, const ParticleSet& particles) {
  std::vector<int> chosen;
  for (const localization::SubmapBelief& belief : states.posterior(particles)) {
    const auto best = std::max_element(belief.probability.begin(), belief.probability.end());
    chosen.push_back(static_cast<int>(best - belief.probability.begin()));
  }
  return chosen;
}

/// Casts in the maps that configurations compose, each made once: few of their combinations occur
/// in a run. Any threads.
class ComposedCasters {
 public:
  explicit ComposedCasters(std::shared_ptr<const patch::PatchMap> map) : map_(std::move(map)) {}
  [[nodiscard]] std::shared_ptr<const RayCaster> of(const std::vector<int>& chosen) {
    const std::lock_guard lock(mutex_);
    std::shared_ptr<const RayCaster>& caster = casters_[chosen];
    if (!caster) caster = std::make_shared<const RayCaster>(patch::compose(*map_, chosen));
    return caster;
  }

 private:
  std::shared_ptr<const patch::PatchMap> map_;
  std::mutex mutex_;
  std::map<std::vector<int>, std::shared_ptr<const RayCaster>> casters_;
};

MapModel patch_model(const patch::PatchMap& learned, const PatchBeamModelConfig& config) {
  const auto map = std::make_shared<const patch::PatchMap>(learned);
  const auto sensor = std::make_shared<const patch_beams::PatchBeamModel>(map, config);
  MapModel model;
  model.sensor = sensor;
  model.best_prediction =
      [sensor, casters = std::make_shared<ComposedCasters>(map)](const ParticleSet& particles) {
        return ranges_of(casters->of(believed(*sensor->patch_states(), particles)));
      };
  model.bytes = map->base.size();
  model.resident_bytes = map->base.size() * (sizeof(float) + kCasterBytes);
  for (const patch::Submap& submap : map->submaps) {
    const std::size_t cells = submap.rect.area() * submap.configurations.size();
    model.bytes += cells;
    model.resident_bytes += cells * (sizeof(float) + sizeof(CellCounts)) + submap.rect.area();
  }
  return model;
}

/// memory: nothing for the one that the settings name.
MapModelDescriptor patch_descriptor(const char* name, const char* description, MapPart part,
                                    std::optional<PatchMemory> memory) {
  MapModelDescriptor model;
  model.name = name;
  model.family = "patch";
  model.description = description;
  model.needs = {part};
  model.learns = MapLearning::kSubmapStates;
  const auto map = part == MapPart::kPatches ? &Maps::patches : &Maps::place_patches;
  model.make = [map, memory](const Maps& maps, const std::string& /*argument*/,
                             PatchBeamModelConfig config) {
    if (memory) config.states.memory = *memory;
    if (memory == PatchMemory::kNone) config.states.rates = localization::RateSource::kFixed;
    return patch_model(*(maps.*map), config);
  };
  return model;
}

}  // namespace

void add_patch(MapModels& models) {
  MapModelDescriptor patch = patch_descriptor(
      "patch", "sub-maps that change, with the memory that sensor.states.memory names",
      MapPart::kPatches, std::nullopt);
  patch.is_compared = true;
  models.add(std::move(patch));
  models.add(patch_descriptor("patch_paper", "... without memory, as the paper has it",
                              MapPart::kPatches, PatchMemory::kNone));
  models.add(patch_descriptor("patch_shared", "... with one memory for all particles",
                              MapPart::kPatches, PatchMemory::kShared));
  models.add(patch_descriptor("patch_per_particle", "... with a memory in every particle",
                              MapPart::kPatches, PatchMemory::kPerParticle));
  MapModelDescriptor by_places = patch_descriptor(
      "patch_places", "as patch, with sub-maps that follow the places of a topology",
      MapPart::kPlacePatches, std::nullopt);
  by_places.in_own_folder = "patch";
  models.add(std::move(by_places));
}

}  // namespace strata::maps
