// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/spliced_drive.hpp"

#include "components/maps/map_model.hpp"

namespace strata::experiments {

std::shared_ptr<const localization::SensorModel> sensor_of(const VerdictWorld& world,
                                                           const std::string& model) {
  if (model == "field") {
    return maps::make_likelihood_field_model(world.maps, "filtered", {}).sensor;
  }
  return maps::make_map_model(world.maps, model, pipeline::CompareConfig{}.sensor).sensor;
}

bool is_sure(const localization::LocalizationResult& result) {
  return result.converged && !result.is_ambiguous &&
         result.health.state == localization::HealthState::kGood;
}

std::size_t known_from(const VerdictWorld& world, std::size_t at) {
  while (at < world.truths.size() && !world.truths[at]) ++at;
  return at;
}

}  // namespace strata::experiments
