// SPDX-License-Identifier: Apache-2.0
/// `timescale` and its kin: levels of the timescale memory.
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/maps/models/ranges.hpp"
#include "components/maps/timescale_model.hpp"

namespace strata::maps {
namespace {

using patch_beams::PatchBeamModelConfig;

/// The levels know nothing beyond their outermost bin: readings from there on count as no return.
/// level: the only one to believe; nothing: all of them, mixed.
MapModel timescale_model(const Maps& maps, PatchBeamModelConfig config, bool goes_on_learning,
                         const std::optional<std::string>& level) {
  const std::shared_ptr<const memory::NodeMap> nodes =
      maps.nodes ? maps.nodes : maps.timescale->decode(maps.decoding);
  const std::size_t bytes = maps.timescale ? maps.timescale->bytes() : nodes->bytes();
  double& limit_m = config.beam.beams.max_range_m;
  const double reach_m = nodes->bins().max_range_m;
  limit_m = limit_m > 0.0 ? std::min(limit_m, reach_m) : reach_m;
  TimescaleUse use;
  // A map from its topic shows what the memory expects, not what it remembers.
  use.goes_on_learning = goes_on_learning && maps.timescale != nullptr;
  if (level) use.level = nodes->level_index(*level);
  use.min_score = maps.timescale_use.min_score;
  const auto base = maps.timescale_use.base_map ? caster_of_filtered(maps) : nullptr;
  const auto sensor =
      std::make_shared<const TimescaleModel>(maps.timescale, nodes, config.beam, use, base);
  MapModel model;
  model.sensor = sensor;
  model.best_prediction = [ranges = ranges_of(sensor)](const localization::ParticleSet&) {
    return ranges;
  };
  const std::size_t levels = use.level ? nodes->level_names().size() : 1;
  const std::size_t base_cells = base ? maps.filtered.size() : 0;
  model.bytes = bytes / levels + base_cells;
  model.resident_bytes =
      ((maps.timescale ? maps.timescale->bytes() : 0) + nodes->bytes()) / levels +
      base_cells * kCasterBytes;
  return model;
}

std::vector<std::string> level_names(const Maps& maps) {
  if (!maps.timescale) return maps.nodes->level_names();
  std::vector<std::string> names;
  for (const memory::LevelConfig& level : maps.timescale->config().levels) {
    names.push_back(level.name);
  }
  return names;
}

MapModelDescriptor levels_descriptor(const char* name, const char* description,
                                     MapLearning learns) {
  MapModelDescriptor model;
  model.name = name;
  model.family = "timescale";
  model.description = description;
  model.needs = {MapPart::kTimescale};
  model.learns = learns;
  model.make = [learns](const Maps& maps, const std::string& /*argument*/,
                        const PatchBeamModelConfig& config) {
    return timescale_model(maps, config, learns == MapLearning::kMemory, std::nullopt);
  };
  return model;
}

}  // namespace

void add_timescale(MapModels& models) {
  MapModelDescriptor timescale = levels_descriptor(
      "timescale", "all levels of the memory, each weighted by how well it explains the scans",
      MapLearning::kMemory);
  timescale.is_compared = true;
  models.add(std::move(timescale));
  models.add(levels_descriptor("timescale_mixture", "the same as timescale", MapLearning::kMemory));
  models.add(levels_descriptor("timescale_frozen", "the same in the memory as it was learned",
                               MapLearning::kLevelWeights));
  MapModelDescriptor level =
      levels_descriptor("timescale_", "one level of the memory", MapLearning::kMemory);
  level.argument = "LEVEL";
  level.arguments = level_names;
  level.make = [](const Maps& maps, const std::string& argument,
                  const PatchBeamModelConfig& config) {
    return timescale_model(maps, config, true, argument);
  };
  models.add(std::move(level));
}

}  // namespace strata::maps
