// SPDX-License-Identifier: Apache-2.0
/// When tests interrupt or kill the program, and what it left.
#pragma once

#include <cstddef>
#include <filesystem>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "tests/tools/strata/replay_fixture.hpp"

namespace strata::test {

/// One moment in each of `count` equal parts of the time.
inline std::vector<double> moments(double whole_s, int count) {
  std::mt19937 random(20);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same moments every time
  std::vector<double> result;
  for (int i = 0; i < count; ++i) {
    const double place = static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
    result.push_back(whole_s * (i + place) / count);
  }
  return result;
}

/// The paths of the files below a folder.
inline std::set<std::string> file_names(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& [name, bytes] : contents(folder)) names.insert(name);
  return names;
}

}  // namespace strata::test
