// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/zone_topics.hpp"

#include <cstdint>
#include <exception>
#include <map>
#include <string_view>
#include <utility>

#include "components/maps/maps_folder.hpp"
#include "components/site/active_maps.hpp"
#include "core/base/error.hpp"

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

void ZoneTopics::send(Topic& topic, const site::Zones& zones, const ReflectionGrid& map) {
  const site::ZoneMask mask =
      site::mask_of(zones, topic.kind, map, site::mask_rect(zones, map, topic.kind),
                    {config_.preferred_cost_percent});
  const std::size_t hash = hash_of(mask);
  if (topic.sent == hash) return;
  topic.mask.send(mask.values, mask.meaning, now_(), map_frame_);
  topic.sent = hash;
}

std::string ZoneTopics::send(const site::Site& site) {
  const site::Zones zones = site.zones();
  const ReflectionGrid map =
      maps::open_for_reading(site::real_maps(site.folder())).load_reflection_grid("filtered");
  std::map<std::string, std::string> kinds_of;  // by what is wrong with them
  for (Topic& topic : topics_) {
    try {
      send(topic, zones, map);
    } catch (const std::exception& error) {  // stairs stay closed whatever is wrong with a speed
      std::string& kinds = kinds_of[error.what()];
      kinds += (kinds.empty() ? "" : ", ") + std::string(site::name_of(topic.kind));
    }
  }
  std::string fault;
  for (const auto& [why, kinds] : kinds_of) {
    fault += "its zones of " + kinds + " are not used as they are now: " + why + "; ";
  }
  if (!fault.empty()) return fault.substr(0, fault.size() - 2);
  try {
    return site::narrow_zones(zones, map.resolution_m(), site::mask_rect(zones, map));
  } catch (const InputError&) {  // too far from each other to be looked at as one
    return "";
  }
}

std::string ZoneTopics::fault() const {
  const std::lock_guard lock(mutex_);
  return fault_;
}

}  // namespace strata::localizer
