// SPDX-License-Identifier: Apache-2.0
#include "components/bus/domain_view.hpp"

#include <array>
#include <span>
#include <utility>

#include "core/base/hex_text.hpp"

namespace strata::bus {

std::string guid_text(const Guid& guid) {
  std::string text;
  for (std::size_t i = 0; i < guid.size(); ++i) {
    if (i > 0 && i % 4 == 0) text += '.';
    text += hex_text({&guid[i], 1});
  }
  return text;
}

std::string vendor_name(std::uint16_t vendor) {
  // https://www.dds-foundation.org/dds-rtps-vendor-and-product-ids
  constexpr std::array<std::pair<std::uint16_t, const char*>, 5> kKnown = {
      {{0x0101, "RTI Connext"},
       {0x0103, "OpenDDS"},
       {kVendorFastDds, "Fast DDS"},
       {kVendorCyclone, "Cyclone DDS"},
       {0x0111, "GurumDDS"}}};
  for (const auto& [id, name] : kKnown) {
    if (id == vendor) return name;
  }
  const std::array<std::uint8_t, 2> bytes{static_cast<std::uint8_t>(vendor >> 8U),
                                          static_cast<std::uint8_t>(vendor & 255U)};
  return "vendor " + hex_text(std::span(bytes).first(1)) + "." + hex_text(std::span(bytes).last(1));
}

}  // namespace strata::bus
