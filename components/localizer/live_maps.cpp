// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/live_maps.hpp"

#include <memory>
#include <utility>

#include "components/convert/map_messages.hpp"
#include "components/convert/patch_messages.hpp"
#include "components/maps/node_map_message.hpp"
#include "core/base/error.hpp"
#include "core/rays/ray_caster.hpp"

namespace strata::localizer {

using maps::MapPart;

LiveMaps::LiveMaps(maps::MapModels::Pointer model, const MapTopicsConfig& config)
    : model_(std::move(model)), config_(config) {
  if (model_->follows_topics()) return;
  throw ConfigError("model " + model_->shown_name(), "is made of a map that comes over no topic",
                    "choose another, or name a folder in maps and leave map_topics.follow");
}

void LiveMaps::begin_with(const maps::Maps& maps) {
  maps_ = maps;
  came_.clear();
  taken_.clear();
}

bool LiveMaps::needs(MapPart part) const {
  if (model_->needs_part(part)) return true;
  // The free space.
  return part == MapPart::kFiltered && !model_->needs_part(MapPart::kOccupancy);
}

void LiveMaps::add(const nav_msgs::msg::OccupancyGrid& message, const MapMessage& from) {
  maps_.occupancy = convert::from_message(message);
  note(from);
  if (!needs(MapPart::kFiltered)) {
    maps_.filtered = maps_.occupancy;  // the free space
    maps_.filtered_caster.reset();
  }
  is_new_ = true;
}

void LiveMaps::add(const strata_msgs::msg::ReflectionGrid& message, const MapMessage& from) {
  maps_.filtered = convert::from_message(message);
  note(from);
  maps_.filtered_caster.reset();
  // For the other models it is only the free space: they wait for news of their own.
  is_new_ = is_new_ || model_->needs_part(MapPart::kFiltered);
}

void LiveMaps::add(const strata_msgs::msg::PatchMap& message, const MapMessage& from) {
  maps_.patches = convert::from_message(message);
  note(from);
  maps_.filtered = maps_.patches->base;  // the free space, as of now
  maps_.filtered_caster.reset();
  is_new_ = true;
}

void LiveMaps::add(const strata_msgs::msg::NodeMap& message, const MapMessage& from) {
  const memory::NodeMap* before = is_apart_ ? nullptr : maps_.nodes.get();
  maps_.nodes = maps::from_message(message, {config_.own_place_m}, before);
  maps_.timescale.reset();  // that of the folder: who publishes knows more by now
  note({from.topic, from.type, before == nullptr ? from.sha256 : ""});
  is_new_ = is_new_ || !message.nodes().empty();
}

/// Later messages of a type undo what earlier ones did, of whatever type: only the order in which
/// the last ones came matters.
void LiveMaps::note(const MapMessage& from) {
  std::erase_if(came_, [&](const MapMessage& one) { return one.type == from.type; });
  came_.push_back(from);
}

bool LiveMaps::is_complete() const {
  return maps_.filtered.size() > 0 && model_->is_made_of(maps_);
}

const maps::Maps& LiveMaps::take() {
  is_new_ = false;
  taken_ = came_;
  const bool casts = maps_.timescale_use.base_map && model_->needs_part(MapPart::kTimescale);
  // A node map comes every second, the grid below it once: its distances are worked out once.
  if (casts && !maps_.filtered_caster) {
    maps_.filtered_caster = std::make_shared<const rays::RayCaster>(maps_.filtered);
  }
  return maps_;
}

}  // namespace strata::localizer
