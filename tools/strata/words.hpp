// SPDX-License-Identifier: Apache-2.0
/// Numbers in sentences for people.
#pragma once

#include <cstddef>
#include <string>

namespace strata::tools {

/// "1 place differs", "3 places differ".
[[nodiscard]] inline std::string counted(std::size_t count, const std::string& one,
                                         const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

/// "1 place", "3 places".
[[nodiscard]] inline std::string counted(std::size_t count, const std::string& noun) {
  return counted(count, noun, noun + "s");
}

}  // namespace strata::tools
