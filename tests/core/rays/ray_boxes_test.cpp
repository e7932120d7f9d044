// SPDX-License-Identifier: Apache-2.0
#include "core/rays/ray_boxes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata::rays {
namespace {

constexpr double kNothing = std::numeric_limits<double>::infinity();

/// Eight lasers in a world with three boxes, one of which does not count for every third laser, and
/// one of which is uniform.
struct BoxedBundles {
  std::vector<RayBox> boxes;
  std::vector<double> cosine{1.0, 0.0, -1.0, 0.0}, sine{0.0, 1.0, 0.0, -1.0};
  std::vector<double> x, y, heading_cosine, heading_sine;
  std::vector<std::vector<double>> columns;  // five a box
  std::vector<double> hidden = std::vector<double>(BeamBundles::kVector, 7.0);
  std::vector<BoxColumns> relative;
  static constexpr std::size_t kUniform = 2;
  static constexpr std::size_t kBundles = BeamBundles::kVector;

  explicit BoxedBundles(RandomStream& random) {
    for (int k = 0; k < 9; ++k) {
      const double angle = random.uniform(-3.1, 3.1);
      cosine.push_back(std::cos(angle));
      sine.push_back(std::sin(angle));
    }
    for (std::size_t n = 0; n < kBundles; ++n) {
      const double heading = n == 0 ? 0.0 : random.uniform(-3.1, 3.1);
      x.push_back(random.uniform(-3.0, 3.0));
      y.push_back(random.uniform(-3.0, 3.0));
      heading_cosine.push_back(std::cos(heading));
      heading_sine.push_back(std::sin(heading));
    }
    for (std::size_t b = 0; b < 3; ++b) {
      const double low_x = random.uniform(-4.0, 4.0);
      const double low_y = random.uniform(-4.0, 4.0);
      boxes.push_back(
          {low_x, low_y, low_x + random.uniform(0.1, 2.0), low_y + random.uniform(0.1, 2.0)});
      columns.resize(columns.size() + 5, std::vector<double>(kBundles));
      std::vector<double>* const column = &columns[5 * b];
      for (std::size_t n = 0; n < kBundles; ++n) {
        column[0][n] = boxes[b].min_x_m - x[n];
        column[1][n] = boxes[b].min_y_m - y[n];
        column[2][n] = boxes[b].max_x_m - x[n];
        column[3][n] = boxes[b].max_y_m - y[n];
        const double dx = std::max({column[0][n], -column[2][n], 0.0});
        const double dy = std::max({column[1][n], -column[3][n], 0.0});
        column[4][n] = counts(b, n) ? std::hypot(dx, dy) : kNothing;
      }
    }
    for (std::size_t b = 0; b < 3; ++b) {
      const std::vector<double>* const column = &columns[5 * b];
      relative.push_back({column[0].data(), column[1].data(), column[2].data(), column[3].data(),
                          column[4].data(), hidden.data(), std::ldexp(1.0, static_cast<int>(b)),
                          static_cast<std::uint32_t>(b), b == kUniform});
    }
  }
  static bool counts(std::size_t box, std::size_t bundle) { return box != 1 || bundle % 3 != 0; }
  [[nodiscard]] BeamBundles bundles() const {
    return {x.data(), y.data(),      heading_cosine.data(), heading_sine.data(),
            kBundles, cosine.data(), sine.data(),           cosine.size(),
            5.0};
  }
};

/// Where steps of 2 mm along a ray are in boxes that count.
struct Steps {
  double first_m = kNothing;
  double last_m = -1.0;
  std::uint64_t boxes = 0;
  Steps(const BoxedBundles& world, std::size_t bundle, double c, double s, double limit_m) {
    for (double t = 0.0; t < limit_m; t += 0.002) {
      const double x = world.x[bundle] + t * c;
      const double y = world.y[bundle] + t * s;
      for (std::size_t b = 0; b < world.boxes.size(); ++b) {
        const RayBox& box = world.boxes[b];
        if (x <= box.min_x_m || x >= box.max_x_m || y <= box.min_y_m || y >= box.max_y_m) continue;
        if (!BoxedBundles::counts(b, bundle)) continue;
        boxes |= std::uint64_t{1} << b;
        first_m = std::min(first_m, t);
        last_m = t;
      }
    }
  }
};

/// What cross_boxes finds of one beam.
struct Found {
  static constexpr std::size_t kRoom = BoxedBundles::kBundles + BoxCrossings::kSlack;
  std::vector<double> bundle, cosine, sine, from, to, boxes;
  std::size_t count = 0;
  SingleRow row;  // the first
  std::vector<double> row_from, row_to, row_hidden;
  SingleRows single;

  Found(const BoxedBundles& world, std::size_t beam, const std::vector<double>& end) {
    for (auto* column : {&bundle, &cosine, &sine, &from, &to, &boxes}) column->resize(kRoom);
    for (auto* column : {&row_from, &row_to, &row_hidden}) column->resize(3 * BeamBundles::kVector);
    rows.resize(3);
    single = {rows.data(), row_from.data(), row_to.data(), row_hidden.data(), 0};
    count = cross_boxes(
        world.bundles(), beam, end.data(), world.relative,
        {bundle.data(), cosine.data(), sine.data(), from.data(), to.data(), boxes.data()}, single);
    if (single.count > 0) row = rows.front();
  }
  /// Whether that bundle crosses a uniform box alone.
  [[nodiscard]] bool is_single(std::size_t n) const {
    return single.count > 0 && row_to[n] > row_from[n];
  }

 private:
  std::vector<SingleRow> rows;
};

TEST(RayBoxes, AreThoseThatStepsAlongTheRayFallInto) {
  RandomStream random(33, StreamId::kTest);
  int crossed = 0;
  int crossed_alone = 0;
  for (int round = 0; round < 40; ++round) {
    const BoxedBundles world(random);
    for (std::size_t beam = 0; beam < world.cosine.size(); ++beam) {
      std::vector<double> end;
      for (std::size_t n = 0; n < BoxedBundles::kBundles; ++n) {
        end.push_back(n % 3 == 0 ? kNothing : random.uniform(0.0, 6.0));
      }
      const Found found(world, beam, end);
      std::size_t place = 0;
      for (std::size_t n = 0; n < BoxedBundles::kBundles; ++n) {
        const bool is_found = place < found.count && found.bundle[place] == static_cast<double>(n);
        const bool is_single = found.is_single(n);
        ASSERT_FALSE(is_found && is_single);
        const double hc = world.heading_cosine[n];
        const double hs = world.heading_sine[n];
        const double c = hc * world.cosine[beam] - hs * world.sine[beam];
        const double s = hs * world.cosine[beam] + hc * world.sine[beam];
        const Steps steps(world, n, c, s, std::min(end[n], 5.0));
        const std::uint64_t uniform = std::uint64_t{1} << BoxedBundles::kUniform;
        const std::uint64_t boxes =
            is_single ? uniform : static_cast<std::uint64_t>(is_found ? found.boxes[place] : 0.0);
        const double from = is_single ? found.row_from[n] : found.from[place];
        const double to = is_single ? found.row_to[n] : found.to[place];
        ASSERT_EQ(boxes & steps.boxes, steps.boxes);
        ASSERT_EQ(is_found, (boxes & ~uniform) != 0);
        if (boxes == steps.boxes && boxes != 0) {  // no corner between steps
          EXPECT_NEAR(from, steps.first_m, 0.0021);
          EXPECT_NEAR(to, steps.last_m, 0.0021);
          (is_single ? crossed_alone : crossed) += 1;
        }
        if (is_found) {
          EXPECT_EQ(found.cosine[place], c);
          EXPECT_EQ(found.sine[place], s);
          ++place;
        }
        if (is_single) {
          EXPECT_EQ(found.row.beam, beam);
          EXPECT_EQ(found.row.bundle, 0U);
          EXPECT_EQ(found.row.box, BoxedBundles::kUniform);
          EXPECT_EQ(found.row_hidden[n], 7.0);
        }
      }
      EXPECT_EQ(place, found.count);
    }
  }
  EXPECT_GT(crossed, 200);
  EXPECT_GT(crossed_alone, 100);
}

}  // namespace
}  // namespace strata::rays
