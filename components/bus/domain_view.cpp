// SPDX-License-Identifier: Apache-2.0
#include "components/bus/domain_view.hpp"

#include <array>
#include <utility>

namespace strata::bus {
namespace {

std::string hex(std::uint8_t byte) {
  constexpr const char* kDigits = "0123456789abcdef";
  return {kDigits[byte >> 4U], kDigits[byte & 15U]};
}

}  // namespace

std::string guid_text(const Guid& guid) {
  std::string text;
  for (std::size_t i = 0; i < guid.size(); ++i) {
    if (i > 0 && i % 4 == 0) text += '.';
    text += hex(guid[i]);
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
  return "vendor " + hex(static_cast<std::uint8_t>(vendor >> 8U)) + "." +
         hex(static_cast<std::uint8_t>(vendor & 255U));
}

}  // namespace strata::bus
