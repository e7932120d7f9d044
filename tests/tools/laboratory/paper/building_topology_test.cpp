// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/paper/building_topology.hpp"

#include <gtest/gtest.h>

#include "core/base/error.hpp"

namespace strata::paper {
namespace {

pipeline::TopologyAgreement pairs(std::size_t near, std::size_t merged, std::size_t far_merged) {
  pipeline::TopologyAgreement counts;
  counts.near = near;
  counts.near_merged = merged;
  counts.far = 100;
  counts.far_merged = far_merged;
  return counts;
}

TEST(BuildingTopology, IsTrueWithNineOfTenRevisitsAndNoWrongOne) {
  EXPECT_TRUE(is_true(pairs(10, 9, 0)));
  EXPECT_FALSE(is_true(pairs(10, 8, 0)));
  EXPECT_FALSE(is_true(pairs(10, 10, 1)));
  EXPECT_FALSE(is_true(pairs(0, 0, 0))) << "without a pair nothing is shown";
}

TEST(BuildingTopology, SaysWhichLogIsMissing) {
  Setting setting;
  setting.data = "no/data";
  EXPECT_THROW((void)topology_of(setting, freiburg_079()), InputError);
}

}  // namespace
}  // namespace strata::paper
