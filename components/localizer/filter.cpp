// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/filter.hpp"

namespace strata::localizer {

maps::Maps read_maps(const LocalizerComponentConfig& config, const std::filesystem::path& folder) {
  maps::Maps maps = maps::read_maps(folder);
  maps.decoding = config.decoding;
  maps.timescale_use = config.timescale_use;
  return maps;
}

maps::Maps no_maps(const LocalizerComponentConfig& config) {
  maps::Maps none;
  none.timescale_use = config.timescale_use;
  return none;
}

maps::MapModel make_model(const LocalizerComponentConfig& config, const maps::Maps& maps) {
  return config.sensor_model == maps::SensorModelKind::kBeam
             ? maps::make_map_model(maps, config.model, config.sensor)
             : maps::make_likelihood_field_model(maps, config.model, config.likelihood_field);
}

std::unique_ptr<localization::Localizer> make_filter(const LocalizerComponentConfig& config,
                                                     const maps::MapModel& model,
                                                     const maps::Maps& maps, std::uint64_t seed,
                                                     int threads) {
  auto filter =
      std::make_unique<localization::Localizer>(config.localizer, model.sensor, seed, threads);
  filter->set_free_space(maps.filtered);
  return filter;
}

}  // namespace strata::localizer
