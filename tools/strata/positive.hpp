// SPDX-License-Identifier: Apache-2.0
/// An option that takes numbers above 0.
#pragma once

#include <cmath>
#include <string>

#include <CLI/CLI.hpp>

namespace strata::tools {

/// As CLI::PositiveNumber, whose message writes the largest of all numbers out, in 309 digits.
[[nodiscard]] inline CLI::Validator positive() {
  const auto refuse = [](std::string& text) -> std::string {
    double value = 0.0;
    if (CLI::detail::lexical_cast(text, value) && value > 0.0 && std::isfinite(value)) return "";
    return text + " is not a number above 0";
  };
  return {refuse, "POSITIVE"};
}

}  // namespace strata::tools
