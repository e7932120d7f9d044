// SPDX-License-Identifier: Apache-2.0
#include "core/volume/voxel_ray.hpp"

#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include "core/random/stream.hpp"
#include "core/volume/brick_map.hpp"

namespace strata::volume {
namespace {

std::vector<VoxelKey> ours(const VoxelLattice& lattice, const Eigen::Vector3f& a,
                           const Eigen::Vector3f& b) {
  std::vector<VoxelKey> keys;
  trace_ray(lattice, lattice.key_at(a).value(), lattice.key_at(b).value(), a, b,
            [&](const VoxelKey& key) { keys.push_back(key); });
  return keys;
}

std::vector<VoxelKey> octomaps(const octomap::OcTree& tree, const Eigen::Vector3f& a,
                               const Eigen::Vector3f& b) {
  octomap::KeyRay ray;
  EXPECT_TRUE(tree.computeRayKeys({a.x(), a.y(), a.z()}, {b.x(), b.y(), b.z()}, ray));
  std::vector<VoxelKey> keys;
  for (const auto& key : ray) keys.push_back({key[0], key[1], key[2]});
  return keys;
}

TEST(VoxelRay, PassesTheVoxelsOfOctomapInTheirOrder) {
  RandomStream random(1, StreamId::kTest);
  for (const double resolution : {0.05, 0.1, 0.37}) {
    const VoxelLattice lattice(resolution);
    const octomap::OcTree tree(resolution);
    for (int i = 0; i < 20000; ++i) {
      // Every third number lies on a border, every fifth ray runs along an axis.
      const auto number = [&] {
        const double value = random.uniform(-8.0, 8.0);
        return static_cast<float>(i % 3 == 0 ? std::round(value / resolution) * resolution : value);
      };
      const Eigen::Vector3f a(number(), number(), number());
      Eigen::Vector3f b(number(), number(), number());
      if (i % 5 == 0) b[i % 2] = a[i % 2];
      if (i % 10 == 0) b.z() = a.z();
      ASSERT_EQ(ours(lattice, a, b), octomaps(tree, a, b))
          << a.transpose() << " to " << b.transpose();
    }
  }
}

TEST(VoxelRay, IsEmptyWithinOneVoxel) {
  EXPECT_TRUE(ours(VoxelLattice(0.1), {0.01F, 0.01F, 0.01F}, {0.09F, 0.02F, 0.03F}).empty());
}

TEST(Bricks, TakeVoxelsApartAndPutThemTogether) {
  RandomStream random(2, StreamId::kTest);
  for (int i = 0; i < 2000; ++i) {
    const auto number = [&] { return static_cast<std::int32_t>(random.below(65536)); };
    const VoxelKey key{number(), number(), number()};
    EXPECT_EQ(voxel_of(brick_id(key), place_in_brick(key)), key);
  }
}

TEST(Bricks, KeepWhatIsPutInAndComeOutInZOrder) {
  RandomStream random(3, StreamId::kTest);
  BrickMap<int> bricks;
  std::vector<std::uint64_t> ids;
  for (int i = 0; i < 3000; ++i) {
    const auto number = [&] { return static_cast<std::int32_t>(random.below(600)); };
    const std::uint64_t id = brick_id({number(), number(), number()});
    bricks.touch(id) += 1;
    ids.push_back(id);
  }
  int sum = 0;
  for (std::size_t i = 0; i < bricks.size(); ++i) sum += bricks.value(i);
  EXPECT_EQ(sum, 3000);
  for (const std::uint64_t id : ids) ASSERT_NE(bricks.find(id), nullptr);
  EXPECT_EQ(bricks.find(brick_id({60000, 0, 0})), nullptr);
  const auto order = bricks.in_order();
  ASSERT_EQ(order.size(), bricks.size());
  for (std::size_t i = 1; i < order.size(); ++i) {
    EXPECT_LT(brick_order(bricks.ids()[order[i - 1]]), brick_order(bricks.ids()[order[i]]));
  }
}

}  // namespace
}  // namespace strata::volume
