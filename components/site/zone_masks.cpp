// SPDX-License-Identifier: Apache-2.0
#include "components/site/zone_masks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <tuple>
#include <utility>

#include "core/base/error.hpp"

namespace strata::site {
namespace {

constexpr double kWhole_percent = 100.0;
constexpr double kRounding = 1e-6;  // what a product of decimals may lack
constexpr double kLeastStep_m_s = 0.01;

constexpr std::array kAllKinds{MaskKind::kKeepout,      MaskKind::kPreferred,
                               MaskKind::kSpeedPercent, MaskKind::kSpeedMetres,
                               MaskKind::kNeverLearn,   MaskKind::kStaticOnly};

/// Calls visit(Cell) for the cells of a zone within `rect`, some of them twice.
template <typename Visit>
void for_each_cell(const Zone& zone, double resolution_m, const CellRect& rect, Visit&& visit) {
  for (const MetricPolygon& polygon : zone.shape) {
    const Grid<std::uint8_t> cells = cells_in(polygon, resolution_m, rect);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (cells.values()[i] != 0) visit(cells.cell(i));
    }
  }
}

float as_part(int value) { return static_cast<float>(value) / static_cast<float>(kWhole_percent); }
int as_value(float part) {
  return static_cast<int>(std::lround(static_cast<double>(part) * kWhole_percent));
}

/// The greatest of the values of the zones that have one, over what is there.
void put_greatest(ReflectionGrid& mask, const Zones& zones,
                  const std::function<std::optional<int>(const Zone&)>& value_of) {
  for (const Zone& zone : zones.zones) {
    const std::optional<int> value = value_of(zone);
    if (!value) continue;
    for_each_cell(zone, mask.resolution_m(), mask.rect(), [&](const Cell& cell) {
      float& there = mask.at(cell);
      if (!is_known(there) || there < as_part(*value)) there = as_part(*value);
    });
  }
}

void put_keepout(ReflectionGrid& mask, const Zones& zones) {
  put_greatest(mask, zones, [](const Zone& zone) {
    return zone.kind == ZoneKind::kKeepout
               ? std::optional(static_cast<int>(std::ceil(zone.cost_percent - kRounding)))
               : std::nullopt;
  });
}

void put_preferred(ReflectionGrid& mask, const Zones& zones, const ReflectionGrid& map,
                   double cost_percent) {
  const bool has_some = std::any_of(zones.zones.begin(), zones.zones.end(), [](const Zone& zone) {
    return zone.kind == ZoneKind::kPreferred;
  });
  if (!has_some) return;
  const float cost = as_part(static_cast<int>(std::lround(cost_percent)));
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (is_known(map.get(mask.cell(i)))) mask.values()[i] = cost;
  }
  for (const Zone& zone : zones.zones) {
    if (zone.kind != ZoneKind::kPreferred) continue;
    for_each_cell(zone, mask.resolution_m(), mask.rect(), [&](const Cell& cell) {
      if (is_known(map.get(cell))) mask.at(cell) = 0.0F;
    });
  }
}

void put_speed_percent(ReflectionGrid& mask, const Zones& zones) {
  put_greatest(mask, zones, [](const Zone& zone) -> std::optional<int> {
    if (!zone.speed_percent) return std::nullopt;
    return static_cast<int>(std::ceil(kWhole_percent - *zone.speed_percent - kRounding));
  });
}

/// The lowest of the speeds; 0 stays no limit. Returns what one step of the mask is.
double put_speed_metres(ReflectionGrid& mask, const Zones& zones) {
  double greatest_m_s = 0.0;
  for (const Zone& zone : zones.zones) {
    greatest_m_s = std::max(greatest_m_s, zone.speed_m_s.value_or(0.0));
  }
  const double steps = std::ceil(greatest_m_s / (kLeastStep_m_s * kWhole_percent) - kRounding);
  const double step_m_s = kLeastStep_m_s * std::max(1.0, steps);
  for (const Zone& zone : zones.zones) {
    if (!zone.speed_m_s) continue;
    const int value = static_cast<int>(std::floor(*zone.speed_m_s / step_m_s + kRounding));
    if (value < 1) {
      throw InputError("zone '" + zone.name + "'",
                       "is too slow for a mask that has " + std::to_string(greatest_m_s) +
                           " m/s elsewhere, in a hundred steps",
                       "give this one in speed_percent, or a lower speed there");
    }
    for_each_cell(zone, mask.resolution_m(), mask.rect(), [&](const Cell& cell) {
      float& there = mask.at(cell);
      if (there == 0.0F || there > as_part(value)) there = as_part(value);
    });
  }
  return step_m_s;
}

void put_control(ReflectionGrid& mask, const Zones& zones, LearnControl control) {
  const auto controls = learn_control(zones, mask.resolution_m(), mask.rect());
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (controls.values()[i] == static_cast<std::uint8_t>(control)) mask.values()[i] = 1.0F;
  }
}

/// The properties of a zone that has this value in a mask of that kind; nothing where it means
/// nothing. Throws InputError.
std::optional<Zones::Document> properties_of(int value, MaskKind kind, const FilterMeaning& meaning,
                                             const std::string& place) {
  // Decimals: what a multiplier in single precision says is what its writer meant.
  const double meant = std::round((static_cast<double>(meaning.base) +
                                   static_cast<double>(meaning.multiplier) * value) *
                                  1e4) /
                       1e4;
  const auto require = [&](double least, double greatest) {
    if (meant >= least && meant <= greatest) return;
    throw InputError(place,
                     "has cells of value " + std::to_string(value) + ", a speed of " +
                         Zones::Document(meant).dump(),
                     "see --base and --multiplier: a zone has " + Zones::Document(least).dump() +
                         " to " + Zones::Document(greatest).dump());
  };
  switch (kind) {
    case MaskKind::kKeepout:
      if (value == 0) return std::nullopt;
      if (value == 100) return Zones::Document{{"kind", "keepout"}};
      return Zones::Document{{"kind", "keepout"}, {"cost_percent", value}};
    case MaskKind::kPreferred:
      if (value != 0) return std::nullopt;
      return Zones::Document{{"kind", "preferred"}};
    case MaskKind::kSpeedPercent:
      if (value == 0) return std::nullopt;
      require(1.0, kWhole_percent);
      return Zones::Document{{"kind", "speed"}, {"speed_percent", meant}};
    case MaskKind::kSpeedMetres:
      if (value == 0) return std::nullopt;
      require(0.01, 10.0);
      return Zones::Document{{"kind", "speed"}, {"speed_m_s", meant}};
    case MaskKind::kNeverLearn:
    case MaskKind::kStaticOnly:
      if (value == 0) return std::nullopt;
      return Zones::Document{{"kind", "learn"}, {"control", name_of(kind)}};
  }
  return std::nullopt;
}

}  // namespace

const char* name_of(MaskKind kind) {
  constexpr std::array kNames{"keepout",   "preferred",   "speed",
                              "speed_m_s", "never_learn", "static_only"};
  return kNames.at(static_cast<std::size_t>(kind));
}

std::span<const MaskKind> all_mask_kinds() { return kAllKinds; }

MaskKind mask_kind(const std::string& name) {
  std::string known;
  for (const MaskKind kind : kAllKinds) {
    if (name == name_of(kind)) return kind;
    known += (known.empty() ? "" : ", ") + std::string(name_of(kind));
  }
  throw InputError(name, "is no kind of mask", "choose among " + known);
}

FilterMeaning usual_meaning(MaskKind kind) {
  switch (kind) {
    case MaskKind::kSpeedPercent:
      return {1, 100.0F, -1.0F};
    case MaskKind::kSpeedMetres:
      return {2, 0.0F, static_cast<float>(kLeastStep_m_s)};
    case MaskKind::kNeverLearn:
    case MaskKind::kStaticOnly:
      return {3, 0.0F, 1.0F};
    case MaskKind::kKeepout:
    case MaskKind::kPreferred:
      break;
  }
  return {};
}

std::string narrow_zones(const Zones& zones, double resolution_m, const CellRect& rect) {
  std::string names;
  for (const Zone& zone : zones.zones) {
    bool has_some = false;
    for_each_cell(zone, resolution_m, rect, [&](const Cell&) { has_some = true; });
    if (!has_some) names += (names.empty() ? "'" : ", '") + zone.name + "'";
  }
  if (names.empty()) return names;
  return "narrower than the map's cells, these zones do nothing: " + names + "; draw them wider";
}

ZoneMask mask_of(const Zones& zones, MaskKind kind, const ReflectionGrid& map, const CellRect& rect,
                 const MaskConfig& config) {
  const bool is_cost = kind == MaskKind::kKeepout || kind == MaskKind::kPreferred;
  // SpeedFilter and BinaryFilter take no unknown cells; KeepoutFilter passes over them.
  ZoneMask mask{{map.resolution_m(), rect, is_cost ? kUnknownReflection : 0.0F},
                usual_meaning(kind)};
  switch (kind) {
    case MaskKind::kKeepout:
      put_keepout(mask.values, zones);
      break;
    case MaskKind::kPreferred:
      put_preferred(mask.values, zones, map, config.preferred_cost_percent);
      break;
    case MaskKind::kSpeedPercent:
      put_speed_percent(mask.values, zones);
      break;
    case MaskKind::kSpeedMetres:
      mask.meaning.multiplier = static_cast<float>(put_speed_metres(mask.values, zones));
      break;
    case MaskKind::kNeverLearn:
      put_control(mask.values, zones, LearnControl::kNeverLearn);
      break;
    case MaskKind::kStaticOnly:
      put_control(mask.values, zones, LearnControl::kStaticOnly);
      break;
  }
  return mask;
}

Grid<std::uint8_t> learn_control(const Zones& zones, double resolution_m, const CellRect& rect) {
  Grid<std::uint8_t> controls(resolution_m, rect, static_cast<std::uint8_t>(LearnControl::kLearn));
  std::vector<const Zone*> order;
  for (const Zone& zone : zones.zones) {
    if (zone.kind == ZoneKind::kLearn) order.push_back(&zone);
  }
  // The order of the file is whatever the program that wrote it last made of it.
  std::sort(order.begin(), order.end(), [](const Zone* a, const Zone* b) {
    return std::tuple(-area_m2(*a), a->control, a->name) <
           std::tuple(-area_m2(*b), b->control, b->name);
  });
  for (const Zone* zone : order) {
    for_each_cell(*zone, resolution_m, rect, [&](const Cell& cell) {
      controls.at(cell) = static_cast<std::uint8_t>(zone->control);
    });
  }
  return controls;
}

Zones zones_of_mask(const ReflectionGrid& mask, MaskKind kind, const FilterMeaning& meaning,
                    const std::string& name, const std::string& frame, const std::string& place) {
  std::map<int, std::vector<Cell>> by_value;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (is_known(mask.values()[i])) by_value[as_value(mask.values()[i])].push_back(mask.cell(i));
  }
  std::vector<std::pair<int, Zones::Document>> meant;
  for (const auto& [value, cells] : by_value) {
    if (auto properties = properties_of(value, kind, meaning, place)) {
      meant.emplace_back(value, std::move(*properties));
    }
  }
  Zones::Document features = Zones::Document::array();
  for (const auto& [value, properties] : meant) {
    std::vector<MetricPolygon> shape;
    for (const CellPolygon& polygon : outline(by_value.at(value))) {
      shape.push_back(to_metric(polygon, mask.resolution_m()));
    }
    Zones::Document all{{"name", meant.size() == 1 ? name : name + " " + std::to_string(value)}};
    all.update(properties);
    features.push_back(to_feature(shape, std::move(all)));
  }
  return zones_of(to_collection(std::move(features), frame), place);
}

}  // namespace strata::site
