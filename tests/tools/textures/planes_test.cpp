// SPDX-License-Identifier: Apache-2.0
#include "tools/textures/planes.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"

namespace strata::textures {
namespace {

using volume::ColoredVoxel;
using volume::VoxelKey;

const volume::VoxelLattice kLattice(0.1);

std::int32_t middle(int at) { return volume::kLatticeMiddle + at; }

void add(std::vector<ColoredVoxel>& voxels, int x, int y, int z) {
  ColoredVoxel voxel;
  voxel.key = VoxelKey{middle(x), middle(y), middle(z)};
  voxels.push_back(voxel);
}

/// A floor of 20 x 20 voxels and a wall of 12 on its edge at x = 0, which share a row.
std::vector<ColoredVoxel> corner() {
  std::vector<ColoredVoxel> voxels;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) add(voxels, x, y, 0);
    for (int z = 1; z < 12; ++z) add(voxels, 0, y, z);
  }
  return voxels;
}

TEST(Planes, AreTheFloorAndTheWallWithTheRowThatTheyShare) {
  const auto voxels = corner();
  const std::vector<Plane> planes = find_planes(voxels, kLattice, {});
  ASSERT_EQ(planes.size(), 2U);
  EXPECT_NEAR(std::abs(planes[0].normal.z()), 1.0, 1e-3);
  EXPECT_NEAR(std::abs(planes[1].normal.x()), 1.0, 1e-3);
  EXPECT_EQ(planes[0].voxels.size(), 400U);
  EXPECT_EQ(planes[1].voxels.size(), 240U);
  for (const Plane& plane : planes) {
    EXPECT_NEAR(plane.u.cross(plane.v).dot(plane.normal), 1.0, 1e-9);
  }
  EXPECT_NEAR(planes[1].u.z(), 0.0, 1e-9) << "u is level on a wall";
  EXPECT_NEAR(planes[0].origin_m.z(), 0.05, 1e-9);
}

TEST(Planes, LeaveOutWhatIsSmallAndWhatIsNotFlat) {
  std::vector<ColoredVoxel> voxels;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) add(voxels, i, j, 0);  // 25, five fewer than asked
  }
  EXPECT_TRUE(find_planes(voxels, kLattice, {}).empty());
  PlaneConfig smaller;
  smaller.min_voxels = 25;
  EXPECT_EQ(find_planes(voxels, kLattice, smaller).size(), 1U);
  std::vector<ColoredVoxel> block;
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      for (int z = 0; z < 8; ++z) add(block, x, y, z);
    }
  }
  for (const Plane& plane : find_planes(block, kLattice, {})) EXPECT_LT(plane.voxels.size(), 130U);
  EXPECT_TRUE(find_planes({}, kLattice, {}).empty());
  PlaneConfig wrong;
  wrong.min_voxels = 0;
  EXPECT_THROW((void)find_planes(voxels, kLattice, wrong), ConfigError);
}

}  // namespace
}  // namespace strata::textures
