// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace strata::volume {

/// 24 bits of colour.
struct Rgb {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

/// Of what nothing has told the colour of.
inline constexpr Rgb kGrey{128, 128, 128};

}  // namespace strata::volume
