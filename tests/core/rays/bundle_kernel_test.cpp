// SPDX-License-Identifier: Apache-2.0
#include "core/rays/bundle_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "core/rays/ray_boxes.hpp"
#include "core/rays/ray_caster.hpp"
#include "tests/support/every_target.hpp"

namespace strata::rays {
namespace {

/// Sixteen lasers, some outside the map, with the same 21 beams; and a map with marks 1 to 3.
struct World {
  Grid<std::int32_t> marks{0.05, {{-60, -50}, {80, 70}}};
  RayWalker walker;
  std::vector<double> x, y, column, row, heading_cosine, heading_sine, cosine, sine;
  static constexpr std::size_t kBundles = 2 * BeamBundles::kVector;

  World(RandomStream& random, double density, double reach_m) {
    for (std::int32_t& mark : marks.values()) {
      mark = random.bernoulli(density) ? 1 + static_cast<std::int32_t>(random.below(3)) : 0;
    }
    walker = RayWalker(marks);
    for (std::size_t n = 0; n < kBundles; ++n) {
      const double heading = n % 5 == 0 ? 0.0 : random.uniform(-4.0, 4.0);
      x.push_back(random.uniform(-reach_m, reach_m));
      y.push_back(n % 3 == 0 ? 0.05 * random.below(30) : random.uniform(-reach_m, reach_m));
      column.push_back(walker.table().column_at(x.back()));
      row.push_back(walker.table().row_at(y.back()));
      heading_cosine.push_back(std::cos(heading));
      heading_sine.push_back(std::sin(heading));
    }
    cosine = {1.0, 0.0, -1.0, 0.0};
    sine = {0.0, 1.0, 0.0, -1.0};
    for (int k = 0; k < 17; ++k) {
      const double angle = random.uniform(-4.0, 4.0);
      cosine.push_back(std::cos(angle));
      sine.push_back(std::sin(angle));
    }
  }
  [[nodiscard]] BeamBundles bundles(double max_range_m) const {
    return {column.data(), row.data(),  heading_cosine.data(), heading_sine.data(), kBundles,
            cosine.data(), sine.data(), cosine.size(),         max_range_m};
  }
};

TEST(BundleKernel, GivesEachBundleTheBitsOfItsOwnCastOnEveryTarget) {
  RandomStream random(41, StreamId::kTest);
  for (const double density : {0.0, 0.002, 0.03, 0.3}) {
    for (int round = 0; round < 8; ++round) {
      const World world(random, density, round % 2 == 0 ? 2.0 : 5.0);
      const double max_range_m = random.uniform(0.5, 9.0);
      const BeamBundles bundles = world.bundles(max_range_m);
      std::vector<double> expected(bundles.beams * bundles.count);
      for (std::size_t n = 0; n < bundles.count; ++n) {
        std::vector<double> range(bundles.beams);
        std::vector<std::int32_t> cell(bundles.beams);
        cast_rays(world.walker.table(),
                  {world.x[n], world.y[n], world.heading_cosine[n], world.heading_sine[n],
                   bundles.cosine, bundles.sine, bundles.beams, max_range_m},
                  range.data(), cell.data());
        for (std::size_t b = 0; b < bundles.beams; ++b) expected[b * bundles.count + n] = range[b];
      }
      test::for_every_target([&] {
        std::vector<double> range(expected.size());
        cast_bundles(world.walker.table(), bundles, range.data());
        ASSERT_EQ(range, expected);
      });
    }
  }
}

TEST(BundleKernel, FollowsRowsAsRaysOneByOneThroughHiddenCells) {
  RandomStream random(42, StreamId::kTest);
  std::size_t met = 0;
  std::size_t missed = 0;
  for (int round = 0; round < 20; ++round) {
    const World world(random, 0.02, 2.0);
    const BeamBundles bundles = world.bundles(6.0);
    std::vector<SingleRow> rows(31);
    std::vector<double> from, to, hidden;
    for (SingleRow& row : rows) {
      row = {random.below(static_cast<std::uint32_t>(bundles.beams)),
             static_cast<std::uint32_t>(BeamBundles::kVector) * random.below(2), 0};
      for (std::size_t j = 0; j < BeamBundles::kVector; ++j) {
        from.push_back(random.uniform(0.0, 0.2));
        to.push_back(from.back() + random.uniform(-0.02, 0.25));
        hidden.push_back(static_cast<double>(random.below(7)) - 3.0);
      }
    }
    // Rays one by one: a batch of one, in a map of one mark where it is the only one that counts.
    std::vector<RayWalker> alone;
    for (std::int32_t mark = 1; mark <= 3; ++mark) {
      Grid<std::int32_t> marks = world.marks;
      for (std::int32_t& m : marks.values()) m = m == mark ? m : 0;
      alone.emplace_back(marks);
    }
    std::vector<double> expected;
    for (std::size_t k = 0; k < from.size(); ++k) {
      const SingleRow& row = rows[k / BeamBundles::kVector];
      const std::size_t n = row.bundle + k % BeamBundles::kVector;
      const double c = world.heading_cosine[n] * world.cosine[row.beam] -
                       world.heading_sine[n] * world.sine[row.beam];
      const double s = world.heading_sine[n] * world.cosine[row.beam] +
                       world.heading_cosine[n] * world.sine[row.beam];
      const auto in_column = [](double value) {
        return std::vector<double>(1 + RayBatch::kSlack, value);
      };
      const std::vector<double> columns[] = {in_column(world.column[n]),
                                             in_column(world.row[n]),
                                             in_column(c),
                                             in_column(s),
                                             in_column(from[k]),
                                             in_column(to[k]),
                                             in_column(std::max(0.0, hidden[k]))};
      std::vector<double> range(1 + RayBatch::kSlack);
      std::vector<std::int32_t> mark(1 + RayBatch::kSlack);
      const RayWalker& walker =
          hidden[k] < 0.0 ? alone[static_cast<std::size_t>(-hidden[k]) - 1] : world.walker;
      cast_batch(walker.table(),
                 {columns[0].data(), columns[1].data(), columns[2].data(), columns[3].data(),
                  columns[4].data(), columns[5].data(), columns[6].data(), 1, 6.0},
                 range.data(), mark.data());
      expected.push_back(range[0]);
      (std::isfinite(range[0]) ? met : missed) += 1;
    }
    test::for_every_target([&] {
      std::vector<double> range(expected.size());
      cast_rows(world.walker.table(), bundles,
                {rows.data(), from.data(), to.data(), hidden.data(), rows.size()}, range.data());
      ASSERT_EQ(range, expected);
    });
  }
  EXPECT_GT(met, 100U);
  EXPECT_GT(missed, 100U);
}

}  // namespace
}  // namespace strata::rays
