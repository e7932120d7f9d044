// SPDX-License-Identifier: Apache-2.0
#include "core/topology/place_names.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata::topology {
namespace {

using Names = std::vector<int>;

TEST(PlaceNames, StayWithTheirPlacesWhenLabelsAreNumberedAnew) {
  PlaceNames names;
  EXPECT_EQ(names.update({0}), Names({1}));
  EXPECT_EQ(names.update({0, 1}), Names({1, 2}));
  EXPECT_EQ(names.update({0, 1, 2, 0}), Names({1, 2, 3}));
  // The second visit was at the first place after all: the third landmark has label 1 now.
  EXPECT_EQ(names.update({0, 0, 1, 0, 1}), Names({1, 3}));
  // ... and it was not.
  EXPECT_EQ(names.update({0, 1, 2, 0, 2, 1}), Names({1, 2, 3}));
}

TEST(PlaceNames, OfTwoThatBecomeOneThatOfMoreVisitsStays) {
  PlaceNames names;
  names.update({0});
  names.update({0, 1});
  names.update({0, 1, 1, 1, 2});
  EXPECT_EQ(names.names(), Names({1, 2, 3}));
  EXPECT_EQ(names.update({0, 0, 0, 0, 1}), Names({2, 3}));
}

/// Whatever it changes its mind about.
TEST(PlaceNames, AreNeverTwoAlikeAndNeverOfAPlaceThatSharesNoVisit) {
  RandomStream random(5, StreamId::kTest);
  PlaceNames names;
  Labels labels;
  Names first_names;  // of each visit
  int newest = 0;
  for (int visit = 0; visit < 200; ++visit) {
    labels.push_back(static_cast<int>(random.uniform() * 12.0));
    if (random.uniform() < 0.5) {
      labels[static_cast<std::size_t>(random.uniform() * static_cast<double>(labels.size()))] =
          static_cast<int>(random.uniform() * 12.0);
    }
    const Labels now = canonical(labels);
    const Names given = names.update(now);
    ASSERT_EQ(given.size(), static_cast<std::size_t>(landmark_count(now)));
    EXPECT_EQ(std::set<int>(given.begin(), given.end()).size(), given.size());
    for (std::size_t label = 0; label < given.size(); ++label) {
      bool is_shared = given[label] > newest;  // a new name
      for (std::size_t i = 0; i < first_names.size(); ++i) {
        is_shared =
            is_shared || (now[i] == static_cast<int>(label) && first_names[i] == given[label]);
      }
      EXPECT_TRUE(is_shared) << given[label];
    }
    for (const int name : given) newest = std::max(newest, name);
    first_names.push_back(given[static_cast<std::size_t>(now.back())]);
  }
}

}  // namespace
}  // namespace strata::topology
