// SPDX-License-Identifier: Apache-2.0
#include "core/refinement/surface_field.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strata::refinement {
namespace {

/// Beams that end farther than this from any surface match none: a pose that is refined is a few
/// centimetres off, and less room keeps what was put beside a wall from pulling.
constexpr registration::MatchFieldConfig kField{.radius_m = 0.3};

registration::SurfacePoint point_of(const SurfaceLayer& layer, std::size_t i) {
  const SurfaceCell& cell = layer.cells[i];
  const double angle_rad = (cell.normal + 0.5) / 256.0 * std::numbers::pi;
  registration::SurfacePoint point;
  point.x_m = layer.position_m(i).x();
  point.y_m = layer.position_m(i).y();
  point.normal_x = std::cos(angle_rad);
  point.normal_y = std::sin(angle_rad);
  point.tangential = std::clamp((cell.tangential + 0.5) / 256.0, 0.02, 1.0);
  // The next cell of a wall goes on where this one ends.
  point.slack_m = point.tangential < 0.5 ? layer.resolution_m : 0.0;
  return point;
}

}  // namespace

SurfaceField::SurfaceField(const ReflectionGrid& map, const SurfaceLayer& layer,
                           const patch::PatchMap* patches)
    : field_(map.resolution_m(), kField),
      submap_count_(patches == nullptr ? 0 : patches->submaps.size()) {
  if (layer.cells.empty() || layer.resolution_m != map.resolution_m()) {
    field_ = registration::MatchField(
        map, {.radius_m = kField.radius_m,
              .occupied_reflection = static_cast<double>(kOccupiedReflection)});
    stddev_m_ = map.resolution_m() / std::sqrt(12.0);  // anywhere in its cell
    return;
  }
  for (std::size_t i = 0; i < layer.cells.size(); ++i) add_cell(map, patches, layer, i);
  field_.forget_distances();
}

void SurfaceField::add_cell(const ReflectionGrid& map, const patch::PatchMap* patches,
                            const SurfaceLayer& layer, std::size_t i) {
  const Cell cell = layer.cell(i);
  const std::vector<std::size_t> at =
      patches == nullptr ? std::vector<std::size_t>() : patch::submaps_at(*patches, cell);
  if (at.empty()) {
    if (is_occupied((patches == nullptr ? map : patches->base).get(cell))) {
      field_.add(point_of(layer, i));
    }
    return;
  }
  const std::size_t configurations = patches->submaps[at.front()].configurations.size();
  Changing changing{field_.points().size(), at.front(), {}};
  for (std::size_t k = 0; k < configurations; ++k) {
    changing.is_there.push_back(is_occupied(patch::reflection_at(*patches, at.front(), k, cell)));
  }
  const auto times = std::count(changing.is_there.begin(), changing.is_there.end(), true);
  if (times == 0) return;
  field_.add(point_of(layer, i));
  if (static_cast<std::size_t>(times) < configurations) changing_.push_back(std::move(changing));
}

void SurfaceField::believe(const std::vector<localization::SubmapBelief>& submaps,
                           double min_probability) {
  beliefs_.assign(submap_count_, nullptr);
  for (const localization::SubmapBelief& belief : submaps) {
    const auto submap = static_cast<std::size_t>(belief.submap);
    if (belief.submap >= 0 && submap < beliefs_.size()) beliefs_[submap] = &belief.probability;
  }
  for (const Changing& changing : changing_) {
    const std::vector<double>* belief = beliefs_[changing.submap];
    double probability = 0.0;
    for (std::size_t k = 0; belief != nullptr && k < changing.is_there.size(); ++k) {
      if (changing.is_there[k] && k < belief->size()) probability += (*belief)[k];
    }
    registration::SurfacePoint point = field_.points()[changing.point];
    point.occupied = probability >= min_probability;
    field_.set(changing.point, point);
  }
}

}  // namespace strata::refinement
