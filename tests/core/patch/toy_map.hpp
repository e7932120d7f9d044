// SPDX-License-Identifier: Apache-2.0
/// The map of all beams at given poses, with cells of 5 cm.
#pragma once

#include <vector>

#include "core/grid/counting_map.hpp"
#include "core/scan/scan.hpp"

namespace strata::patch::test_world {

inline ReflectionGrid map_of(const std::vector<PosedScan>& scans) {
  CountingMap counts(0.05);
  for (const PosedScan& scan : scans) counts.add(scan);
  return counts.reflection();
}

}  // namespace strata::patch::test_world
