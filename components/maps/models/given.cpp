// SPDX-License-Identifier: Apache-2.0
/// `map`: a grid that was not learned here, and lies in another frame.
#include <memory>
#include <string>
#include <utility>

#include "components/maps/models/ranges.hpp"
#include "core/rays/ray_caster.hpp"

namespace strata::maps {
namespace {

using rays::RayCaster;

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

MapModel make_given(const Maps& maps, const std::string& /*argument*/,
                    const patch_beams::PatchBeamModelConfig& config) {
  const auto ranges = std::make_shared<const MovedRanges>(maps.given, maps.given_from_map);
  MapModel model;
  model.sensor =
      std::make_shared<const localization::RangeProviderModel<MovedRanges>>(ranges, config.beam);
  model.best_prediction = [moved = ranges_of(ranges)](const localization::ParticleSet&) {
    return moved;
  };
  model.bytes = maps.given.size();
  model.resident_bytes = maps.given.size() * kCasterBytes;
  return model;
}

}  // namespace

void add_given(MapModels& models) {
  MapModelDescriptor model;
  model.name = "map";
  model.family = "grid";
  model.description = "the map_server map that `compare --map` names";
  model.needs = {MapPart::kGiven};
  model.make = make_given;
  models.add(std::move(model));
}

}  // namespace strata::maps
