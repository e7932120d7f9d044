// SPDX-License-Identifier: Apache-2.0
#include "core/rays/column_math.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "tests/support/every_target.hpp"

namespace strata::rays {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Calls function(values, count) on every target, with and without a rest after the last whole
/// vector; checks that all give the same and leave what lies behind alone, and returns it.
template <typename Function>
std::vector<double> on_every_target(const std::vector<double>& values, std::size_t count,
                                    Function&& function) {
  std::vector<double> first;
  test::for_every_target([&] {
    std::vector<double> column = values;
    function(column.data(), count);
    for (std::size_t k = count; k < values.size(); ++k) EXPECT_EQ(column[k], values[k]);
    if (first.empty()) first = column;
    EXPECT_EQ(column, first);
  });
  return first;
}

TEST(ColumnMath, ExponentialsAreThoseOfTheLibraryWithTheSameBitsOnEveryTarget) {
  RandomStream random(1, StreamId::kTest);
  std::vector<double> values{0.0, -0.0, 1.0, 700.0, -700.0, -701.0, -kInfinity};
  while (values.size() < 500) values.push_back(random.uniform(-60.0, 60.0));
  for (const std::size_t count : {std::size_t{496}, std::size_t{491}}) {
    const std::vector<double> got = on_every_target(values, count, exp_column);
    for (std::size_t k = 0; k < count; ++k) {
      const double expected = values[k] < -700.0 ? 0.0 : std::exp(values[k]);
      EXPECT_NEAR(got[k], expected, 4e-15 * expected) << values[k];
    }
  }
}

TEST(ColumnMath, LogarithmsAreThoseOfTheLibraryWithTheSameBitsOnEveryTarget) {
  RandomStream random(2, StreamId::kTest);
  std::vector<double> values{1.0, 0.0, 1e-300, 1e-308, 1e300, 0.5, std::sqrt(2.0)};
  while (values.size() < 500) values.push_back(std::exp(random.uniform(-60.0, 60.0)));
  for (const std::size_t count : {std::size_t{496}, std::size_t{491}}) {
    const std::vector<double> got = on_every_target(values, count, log_column);
    for (std::size_t k = 0; k < count; ++k) {
      const double expected = std::log(std::max(values[k], 1e-300));
      EXPECT_NEAR(got[k], expected, 4e-15 * std::abs(expected) + 1e-16) << values[k];
    }
  }
}

TEST(ColumnMath, EveryTargetSumsRowsInTheirOrder) {
  RandomStream random(3, StreamId::kTest);
  constexpr std::size_t kRows = 17;
  for (const std::size_t columns : {std::size_t{64}, std::size_t{13}}) {
    std::vector<double> values;
    for (std::size_t k = 0; k < kRows * columns; ++k) values.push_back(random.normal());
    std::vector<double> expected(columns, 0.0);
    for (std::size_t k = 0; k < values.size(); ++k) expected[k % columns] += values[k];
    test::for_every_target([&] {
      std::vector<double> sums(columns);
      sum_rows(values.data(), kRows, columns, sums.data());
      EXPECT_EQ(sums, expected);
    });
  }
}

}  // namespace
}  // namespace strata::rays
