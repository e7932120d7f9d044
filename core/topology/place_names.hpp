// SPDX-License-Identifier: Apache-2.0
/// What places are called while the topology still changes.
#pragma once

#include <vector>

#include "core/topology/partition.hpp"

namespace strata::topology {

/// Numbers landmarks so that a number stays with its place: labels count by first appearance, so
/// that one change of mind renumbers every landmark behind it. Each visit remembers what its
/// landmark was called when it was made; a landmark has the name of most of its visits, the older
/// one of equals. Two landmarks that become one keep the name of the one with more visits; should
/// they become two again, both have their names back. No name goes to a place without a visit that
/// had it.
class PlaceNames {
 public:
  /// labels: of all visits now, canonical; none fewer than before. Gives the name of each landmark,
  /// by label, no two alike. O(visits x log visits).
  const std::vector<int>& update(const Labels& labels);
  /// Of the last update.
  [[nodiscard]] const std::vector<int>& names() const { return names_; }

 private:
  std::vector<int> first_names_;  // of each visit
  std::vector<int> names_;        // of each landmark
  int next_ = 1;
};

}  // namespace strata::topology
