// SPDX-License-Identifier: Apache-2.0
#include "components/site/learn_limits.hpp"

#include <algorithm>
#include <system_error>

#include "components/site/site.hpp"
#include "components/site/zone_masks.hpp"

namespace strata::site {

LearnLimits learn_limits(const Zones& zones, double resolution_m) {
  Zones about;  // keepout zones may lie anywhere
  for (const Zone& zone : zones.zones) {
    if (zone.kind == ZoneKind::kLearn) about.zones.push_back(zone);
  }
  const CellRect rect = about.zones.empty()
                            ? CellRect{}
                            : mask_rect(about, make_reflection_grid(resolution_m, CellRect{}));
  const Grid<std::uint8_t> controls = learn_control(about, resolution_m, rect);
  const auto cells_of = [&](LearnControl control) {
    Grid<std::uint8_t> cells(resolution_m, rect, 0);
    bool has_some = false;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const bool is_it = controls.values()[i] == static_cast<std::uint8_t>(control);
      cells.values()[i] = is_it ? 1 : 0;
      has_some = has_some || is_it;
    }
    return has_some ? cells : Grid<std::uint8_t>(resolution_m, CellRect{}, 0);
  };
  return {cells_of(LearnControl::kNeverLearn), cells_of(LearnControl::kStaticOnly)};
}

Zones zones_at(const std::filesystem::path& site_or_file) {
  std::error_code error;
  if (std::filesystem::is_directory(site_or_file, error)) return Site(site_or_file).zones();
  return read_zones(site_or_file);
}

}  // namespace strata::site
