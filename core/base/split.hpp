// SPDX-License-Identifier: Apache-2.0
/// Texts of several parts.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace strata {

/// The parts of a text between separators, in order; empty ones are left out.
[[nodiscard]] inline std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    if (end > begin) parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

}  // namespace strata
