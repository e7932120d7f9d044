// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/zone_topics.hpp"

#include <cstdint>
#include <exception>
#include <string_view>
#include <utility>

#include "components/maps/maps_folder.hpp"
#include "components/site/active_maps.hpp"

namespace strata::localizer {
namespace {

/// Of all that a reader would see another way.
std::size_t hash_of(const site::ZoneMask& mask) {
  const auto& values = mask.values.values();
  const CellRect& rect = mask.values.rect();
  std::string rest;
  for (const int side : {rect.min.x, rect.min.y, rect.max.x, rect.max.y}) {
    rest += std::to_string(side) + " ";
  }
  rest +=
      std::to_string(mask.values.resolution_m()) + " " + std::to_string(mask.meaning.multiplier);
  const std::string_view bytes(reinterpret_cast<const char*>(values.data()),
                               values.size() * sizeof(float));
  const std::hash<std::string_view> hash;
  return hash(bytes) ^ (hash(rest) << 1U);
}

}  // namespace

ZoneTopics::ZoneTopics(const ZoneTopicsConfig& config, std::string map_frame,
                       const Advertise& advertise, Now now)
    : config_(config), map_frame_(std::move(map_frame)), now_(std::move(now)) {
  for (const site::MaskKind kind : site::all_mask_kinds()) {
    topics_.push_back({kind, advertise(kind), std::nullopt});
  }
}

void ZoneTopics::tell(const site::Site& site) {
  std::string fault;
  try {
    fault = send(site);
  } catch (const std::exception& error) {
    fault = std::string("its zones are not used as they are now: ") + error.what();
  }
  const std::lock_guard lock(mutex_);
  fault_ = std::move(fault);
}

std::string ZoneTopics::send(const site::Site& site) {
  const site::Zones zones = site.zones();
  const ReflectionGrid map =
      maps::open_for_reading(site::real_maps(site.folder())).load_reflection_grid("filtered");
  const CellRect rect = site::mask_rect(zones, map);
  std::vector<site::ZoneMask> masks;  // all or none
  for (const Topic& topic : topics_) {
    masks.push_back(site::mask_of(zones, topic.kind, map, rect, {config_.preferred_cost_percent}));
  }
  for (std::size_t i = 0; i < topics_.size(); ++i) {
    const std::size_t hash = hash_of(masks[i]);
    if (topics_[i].sent == hash) continue;
    topics_[i].mask.send(masks[i].values, masks[i].meaning, now_(), map_frame_);
    topics_[i].sent = hash;
  }
  return site::narrow_zones(zones, map.resolution_m(), rect);
}

std::string ZoneTopics::fault() const {
  const std::lock_guard lock(mutex_);
  return fault_;
}

}  // namespace strata::localizer
