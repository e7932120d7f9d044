// SPDX-License-Identifier: Apache-2.0
/// What a sequence saw, as one number a configuration: how likely it is in each, or its membership.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace strata::patch {

/// The configuration that speaks for it most, of equal ones the first. Requires at least one.
[[nodiscard]] inline std::size_t likeliest(std::span<const double> look) {
  return static_cast<std::size_t>(std::max_element(look.begin(), look.end()) - look.begin());
}

/// How likely the look is where the configuration is drawn from these shares, to the look's factor.
[[nodiscard]] inline double likelihood(std::span<const double> look,
                                       std::span<const double> shares) {
  double sum = 0.0;
  for (std::size_t k = 0; k < look.size(); ++k) sum += look[k] * shares[k];
  return sum;
}

}  // namespace strata::patch
