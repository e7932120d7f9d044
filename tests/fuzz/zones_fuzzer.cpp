// SPDX-License-Identifier: Apache-2.0
/// Zones of a site: the GeoJSON, written and read again, and its masks; regions.
#include "components/site/zone_masks.hpp"
#include "components/site/zones.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strata;
  (void)fuzz::expect_value_or_error([&] {
    (void)site::parse_region(fuzz::text_of({data, size}), "region.geojson");
  });
  return fuzz::expect_value_or_error([&] {
    const site::Zones zones = site::parse_zones(fuzz::text_of({data, size}), "zones.geojson");
    const std::string text = site::to_text(zones);
    const site::Zones again = site::parse_zones(text, "again");
    if (site::to_text(again) != text || again.zones.size() != zones.zones.size()) __builtin_trap();
    const ReflectionGrid map(0.5, {{-20, -20}, {20, 20}}, 0.0F);
    for (const site::MaskKind kind : site::all_mask_kinds()) {
      (void)site::mask_of(zones, kind, map, map.rect());
    }
    (void)site::mask_rect(zones, map);
  });
}
