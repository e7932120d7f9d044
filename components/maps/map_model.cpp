// SPDX-License-Identifier: Apache-2.0
#include "components/maps/map_model.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "components/maps/timescale_model.hpp"
#include "core/base/error.hpp"
#include "core/localization/ray_caster.hpp"

namespace strata::maps {
namespace {

using localization::ParticleSet;
using localization::PatchBeamModelConfig;
using localization::PatchMemory;
using localization::RayCaster;

constexpr const char* kTimescalePrefix = "timescale_";
/// Of a ray caster, a cell: a distance, and whether it is known. The map itself is not kept.
constexpr std::size_t kCasterBytes = sizeof(float) + 1;

template <typename Provider>
RangeFunction ranges_of(std::shared_ptr<const Provider> provider) {
  return [provider = std::move(provider)](const Pose2& laser, double bearing_rad) {
    return static_cast<double>(provider->expected_range_m(laser, bearing_rad));
  };
}

[[noreturn]] void fail_not_learned(const std::string& name) {
  throw InputError("model " + name, "is not in these maps", "learn it first, or choose another");
}

/// A grid map whose sensor model is made from its ray caster.
template <typename MakeSensor>
MapModel grid_model(const std::string& name, const ReflectionGrid& map, MakeSensor&& make_sensor) {
  if (map.size() == 0) fail_not_learned(name);
  const auto caster = std::make_shared<const RayCaster>(map);
  MapModel model;
  model.name = name;
  model.sensor = make_sensor(caster);
  model.best_prediction = [ranges = ranges_of(caster)](const ParticleSet&) { return ranges; };
  model.bytes = map.size();
  model.resident_bytes = map.size() * kCasterBytes;
  return model;
}

MapModel beam_grid_model(const std::string& name, const ReflectionGrid& map,
                         const PatchBeamModelConfig& config) {
  return grid_model(name, map, [&](const std::shared_ptr<const RayCaster>& caster) {
    return std::make_shared<const localization::RangeProviderModel<RayCaster>>(caster, config.beam);
  });
}

/// Ranges in a map that lies elsewhere than the map frame.
class MovedRanges {
 public:
  MovedRanges(const ReflectionGrid& map, const Pose2& given_from_map)
      : caster_(map), given_from_map_(given_from_map) {}
  [[nodiscard]] double expected_range_m(const Pose2& map_from_laser, double bearing_rad) const {
    return caster_.expected_range_m(given_from_map_ * map_from_laser, bearing_rad);
  }
  [[nodiscard]] bool knows(const Eigen::Vector2d& point_m) const {
    return caster_.knows(given_from_map_ * point_m);
  }
  [[nodiscard]] bool is_near_surface(const Eigen::Vector2d& point_m, double distance_m) const {
    return caster_.is_near_surface(given_from_map_ * point_m, distance_m);
  }

 private:
  RayCaster caster_;
  Pose2 given_from_map_;
};

MapModel given_model(const std::string& name, const Maps& maps,
                     const PatchBeamModelConfig& config) {
  if (maps.given.size() == 0) {
    throw InputError("model " + name, "needs a map that was not learned here",
                     "give its YAML file with --map");
  }
  const auto ranges = std::make_shared<const MovedRanges>(maps.given, maps.given_from_map);
  MapModel model;
  model.name = name;
  model.sensor =
      std::make_shared<const localization::RangeProviderModel<MovedRanges>>(ranges, config.beam);
  model.best_prediction = [moved = ranges_of(ranges)](const ParticleSet&) { return moved; };
  model.bytes = maps.given.size();
  model.resident_bytes = maps.given.size() * kCasterBytes;
  return model;
}

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

MapModel patch_model(const std::string& name, const Maps& maps, PatchBeamModelConfig config) {
  const std::optional<patch::PatchMap>& learned =
      name == "patch_places" ? maps.place_patches : maps.patches;
  if (!learned) fail_not_learned(name);
  if (name == "patch_paper") config.states.memory = PatchMemory::kNone;
  if (name == "patch_shared") config.states.memory = PatchMemory::kShared;
  if (name == "patch_per_particle") config.states.memory = PatchMemory::kPerParticle;
  const auto map = std::make_shared<const patch::PatchMap>(*learned);
  const auto sensor = std::make_shared<const localization::PatchBeamModel>(map, config);
  MapModel model;
  model.name = name;
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

MapModel timescale_model(const std::string& name, const Maps& maps, PatchBeamModelConfig config) {
  if (!maps.timescale && !maps.nodes) fail_not_learned(name);
  const std::shared_ptr<const memory::NodeMap> nodes =
      maps.nodes ? maps.nodes : maps.timescale->decode(maps.decoding);
  const std::size_t bytes = maps.timescale ? maps.timescale->bytes() : nodes->bytes();
  double& limit_m = config.beam.beams.max_range_m;
  const double reach_m = nodes->bins().max_range_m;
  limit_m = limit_m > 0.0 ? std::min(limit_m, reach_m) : reach_m;
  const std::string what =
      name == "timescale" ? "mixture" : name.substr(std::string(kTimescalePrefix).size());
  TimescaleUse use;
  // A map from its topic shows what the memory expects, not what it remembers.
  use.goes_on_learning = what != "frozen" && maps.timescale != nullptr;
  if (what != "mixture" && what != "frozen") use.level = nodes->level_index(what);
  const auto sensor =
      std::make_shared<const TimescaleModel>(maps.timescale, nodes, config.beam, use);
  MapModel model;
  model.name = name;
  model.sensor = sensor;
  model.best_prediction = [ranges = ranges_of(sensor)](const ParticleSet&) { return ranges; };
  const std::size_t levels = use.level ? nodes->level_names().size() : 1;
  model.bytes = bytes / levels;
  model.resident_bytes = ((maps.timescale ? maps.timescale->bytes() : 0) + nodes->bytes()) / levels;
  return model;
}

}  // namespace

std::vector<std::string> model_names(const Maps& maps) {
  std::vector<std::string> names;
  if (maps.occupancy.size() > 0) names.emplace_back("occupancy");
  if (maps.filtered.size() > 0) names.emplace_back("filtered");
  if (maps.patches) {
    for (const char* name : {"patch", "patch_paper", "patch_shared", "patch_per_particle"}) {
      names.emplace_back(name);
    }
  }
  if (maps.place_patches) names.emplace_back("patch_places");
  if (maps.timescale || maps.nodes) {
    names.emplace_back("timescale");
    names.emplace_back("timescale_mixture");
    names.emplace_back("timescale_frozen");
  }
  if (maps.timescale) {
    for (const memory::LevelConfig& level : maps.timescale->config().levels) {
      names.push_back(kTimescalePrefix + level.name);
    }
  } else if (maps.nodes) {
    for (const std::string& level : maps.nodes->level_names()) {
      names.push_back(kTimescalePrefix + level);
    }
  }
  if (maps.given.size() > 0) names.emplace_back("map");
  return names;
}

MapModel make_map_model(const Maps& maps, const std::string& name,
                        const PatchBeamModelConfig& config) {
  if (name == "occupancy") return beam_grid_model(name, maps.occupancy, config);
  if (name == "filtered") return beam_grid_model(name, maps.filtered, config);
  if (name == "map") return given_model(name, maps, config);
  if (name == "patch" || name.starts_with("patch_")) {
    if (name == "patch" || name == "patch_paper" || name == "patch_shared" ||
        name == "patch_per_particle" || name == "patch_places") {
      return patch_model(name, maps, config);
    }
  }
  if (name == "timescale" || name.starts_with(kTimescalePrefix)) {
    return timescale_model(name, maps, config);
  }
  std::string known;
  for (const std::string& candidate : model_names(maps)) {
    known += (known.empty() ? "" : ", ") + candidate;
  }
  throw ConfigError("model " + name, "is unknown", "choose one of " + known);
}

MapModel make_likelihood_field_model(const Maps& maps, const std::string& name,
                                     const localization::LikelihoodFieldModelConfig& config) {
  if (name != "occupancy" && name != "filtered") {
    throw ConfigError("model " + name, "has no likelihood field",
                      "choose occupancy or filtered, or sensor_model=beam");
  }
  const ReflectionGrid& map = name == "occupancy" ? maps.occupancy : maps.filtered;
  return grid_model(name, map, [&](const std::shared_ptr<const RayCaster>& caster) {
    return std::make_shared<const localization::LikelihoodFieldModel>(map, config, caster);
  });
}

}  // namespace strata::maps
