// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/patch_models.hpp"

#include <algorithm>

#include "core/localization/range_provider_model.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "core/rays/ray_caster.hpp"

namespace strata::experiments {
namespace {

using localization::PatchMemory;

Model patch_model(const std::shared_ptr<const patch::PatchMap>& map, PatchMemory memory) {
  patch_beams::PatchBeamModelConfig config;
  config.states.memory = memory;
  if (memory == PatchMemory::kNone) config.states.rates = localization::RateSource::kFixed;
  return std::make_shared<const patch_beams::PatchBeamModel>(map, config);
}

}  // namespace

Model grid_model(const ReflectionGrid& map) {
  return std::make_shared<const localization::RangeProviderModel<rays::RayCaster>>(
      std::make_shared<const rays::RayCaster>(map));
}

Model model_named(const std::string& name, const StaticMaps& maps,
                  const std::shared_ptr<const patch::PatchMap>& patches) {
  if (name == "occupancy") return grid_model(maps.occupancy);
  if (name == "filtered") return grid_model(maps.filtered);
  if (name == "patch_paper") return patch_model(patches, PatchMemory::kNone);
  if (name == "patch_shared") return patch_model(patches, PatchMemory::kShared);
  return patch_model(patches, PatchMemory::kPerParticle);
}

TrueConfigurations true_configurations(const simulate::Simulation& learned,
                                       const patch::PatchMap& map,
                                       const simulate::Simulation& tested, int day) {
  TrueConfigurations result;
  for (const patch::Submap& submap : map.submaps) {
    const auto objects = covered_objects(learned, submap, map.base.resolution_m());
    const std::vector<JointState> meaning = meanings(learned, submap, objects);
    JointState now;
    for (const auto* object : objects) {
      for (const simulate::ChangeableObject& other : tested.objects) {
        if (other.id == object->id) now.push_back(other.state_at(day, 1e9));
      }
    }
    const auto found = std::find(meaning.begin(), meaning.end(), now);
    result.emplace_back();
    if (found != meaning.end() && !now.empty()) {
      result.back() = static_cast<std::size_t>(found - meaning.begin());
    }
  }
  return result;
}

}  // namespace strata::experiments
