// SPDX-License-Identifier: Apache-2.0
#include "core/grid/ray_traversal.hpp"

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "tests/core/grid/clip_reference.hpp"

namespace strata {
namespace {

struct Visit {
  Cell cell;
  double length_m;
};

struct Segment {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
};

void walk(const Segment& segment, double resolution, std::vector<Visit>& visits) {
  visits.clear();
  traverse_ray(segment.from, segment.to, resolution, [&](const Cell& cell, double length) {
    visits.push_back({cell, length});
  });
}

/// What must hold of any walk, whatever its lengths. Returns what is wrong, or null.
const char* structural_fault(const Segment& segment, double resolution,
                             const std::vector<Visit>& visits) {
  const Cell first = cell_at(segment.from, resolution);
  const Cell last = cell_at(segment.to, resolution);
  if (visits.empty() || !(visits.front().cell == first)) return "does not start in its first cell";
  if (!(visits.back().cell == last)) return "does not end in its last cell";
  double sum = 0.0;
  for (std::size_t i = 0; i < visits.size(); ++i) {
    if (!(visits[i].length_m >= 0.0)) return "has a negative length";
    sum += visits[i].length_m;
    if (i == 0) continue;
    const int dx = std::abs(visits[i].cell.x - visits[i - 1].cell.x);
    const int dy = std::abs(visits[i].cell.y - visits[i - 1].cell.y);
    if (std::max(dx, dy) != 1) return "jumps";
  }
  if (std::abs(sum - (segment.to - segment.from).norm()) > 1e-9) return "has another total length";
  return nullptr;
}

/// Whether the lengths per cell equal those of the clipping reference to 1e-9 m.
bool equals_reference(const Segment& segment, double resolution, const std::vector<Visit>& visits) {
  auto expected = test::clip_lengths(segment.from, segment.to, resolution);
  for (const Visit& visit : visits) {
    const auto found = expected.find(visit.cell);
    const double length = found == expected.end() ? 0.0 : found->second;
    if (std::abs(length - visit.length_m) > 1e-9) return false;
    if (found != expected.end()) expected.erase(found);
  }
  for (const auto& [cell, length] : expected) {
    if (length > 1e-9) return false;
  }
  return true;
}

constexpr double kResolutions[] = {0.05, 0.1, 0.03, 1.0, 0.25};

/// Random segments of every kind that matters: anywhere, between lattice corners, on lattice lines,
/// parallel to an axis, diagonal, of no length.
Segment random_segment(RandomStream& random, double resolution) {
  auto anywhere = [&] { return random.uniform(-8.0, 8.0) * resolution * 4.0; };
  auto lattice = [&] { return (static_cast<int>(random.below(33)) - 16) * resolution; };
  auto reach = [&] { return random.uniform(-9.0, 9.0) * resolution; };
  Segment s{{anywhere(), anywhere()}, {0.0, 0.0}};
  switch (random.below(8)) {
    case 0:  // corner to corner
      s.from = {lattice(), lattice()};
      s.to = {lattice(), lattice()};
      return s;
    case 1:  // a border to anywhere
      s.from.x() = lattice();
      break;
    case 2:  // anywhere to a border
      s.to = {s.from.x() + reach(), lattice()};
      return s;
    case 3:  // parallel to x, half of them along a lattice line
      if (random.bernoulli(0.5)) s.from.y() = lattice();
      s.to = {s.from.x() + reach(), s.from.y()};
      return s;
    case 4:  // parallel to y
      if (random.bernoulli(0.5)) s.from.x() = lattice();
      s.to = {s.from.x(), s.from.y() + reach()};
      return s;
    case 5: {  // diagonal through corners
      s.from = {lattice(), lattice()};
      const double d = reach();
      s.to = s.from + Eigen::Vector2d(d, random.bernoulli(0.5) ? d : -d);
      return s;
    }
    case 6:  // no length, half of them on a corner
      if (random.bernoulli(0.5)) s.from = {lattice(), lattice()};
      s.to = s.from;
      return s;
    default:
      break;
  }
  s.to = s.from + Eigen::Vector2d(reach(), reach());
  return s;
}

/// Where a segment leaves a lattice line that it almost follows is not determined by doubles: a
/// rounding of its coordinates moves the crossing by more than the tolerance of the comparison.
bool is_well_conditioned(const Segment& s, double resolution) {
  auto fine = [&](double d) { return d == 0.0 || std::abs(d) > 1e-4 * resolution; };
  return fine(s.to.x() - s.from.x()) && fine(s.to.y() - s.from.y());
}

TEST(RayTraversal, EqualsClippingOnAMillionSegments) {
  RandomStream random(1, StreamId::kTest);
  std::vector<Visit> visits;
  int compared = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const double resolution = kResolutions[i % 5];
    const Segment segment = random_segment(random, resolution);
    walk(segment, resolution, visits);
    const char* fault = structural_fault(segment, resolution, visits);
    ASSERT_EQ(fault, nullptr) << segment.from.transpose() << " to " << segment.to.transpose();
    if (!is_well_conditioned(segment, resolution)) continue;
    ++compared;
    ASSERT_TRUE(equals_reference(segment, resolution, visits))
        << segment.from.transpose() << " to " << segment.to.transpose() << " at " << resolution;
  }
  EXPECT_GT(compared, 999'000);
}

TEST(RayTraversal, StaysWholeForSegmentsThatAlmostFollowALatticeLine) {
  RandomStream random(2, StreamId::kTest);
  std::vector<Visit> visits;
  for (int i = 0; i < 100'000; ++i) {
    const double resolution = kResolutions[i % 5];
    Segment segment = random_segment(random, resolution);
    const double heading = static_cast<double>(random.below(8)) * std::numbers::pi / 4.0;
    const double length = random.uniform(0.0, 500.0) * resolution;
    segment.to = segment.from + length * Eigen::Vector2d(std::cos(heading), std::sin(heading));
    segment.to.x() += random.normal(0.0, 1e-15);
    walk(segment, resolution, visits);
    const char* fault = structural_fault(segment, resolution, visits);
    ASSERT_EQ(fault, nullptr) << segment.from.transpose() << " to " << segment.to.transpose();
  }
}

TEST(RayTraversal, StaysExactOverTensOfThousandsOfCells) {
  RandomStream random(3, StreamId::kTest);
  for (int i = 0; i < 20; ++i) {
    const Segment segment{{random.uniform(-900.0, 900.0), random.uniform(-900.0, 900.0)},
                          {random.uniform(-900.0, 900.0), random.uniform(-900.0, 900.0)}};
    std::vector<Visit> visits;
    walk(segment, 0.05, visits);
    EXPECT_EQ(structural_fault(segment, 0.05, visits), nullptr);
    EXPECT_GT(visits.size(), 1'000U);
    // The entry of each cell lies on the segment, so the sum up to it is its distance.
    double sum = 0.0;
    for (const Visit& visit : visits) {
      const Eigen::Vector2d entry = segment.from + sum * (segment.to - segment.from).normalized();
      const Eigen::Vector2d off =
          entry / 0.05 - Eigen::Vector2d(visit.cell.x + 0.5, visit.cell.y + 0.5);
      ASSERT_LT(off.cwiseAbs().maxCoeff(), 0.5 + 1e-7);
      sum += visit.length_m;
    }
  }
}

TEST(RayTraversal, GoesDiagonallyThroughACorner) {
  std::vector<Visit> visits;
  walk({{0.5, 0.5}, {2.5, 2.5}}, 1.0, visits);
  ASSERT_EQ(visits.size(), 3U);
  EXPECT_EQ(visits[1].cell, (Cell{1, 1}));
  EXPECT_DOUBLE_EQ(visits[1].length_m, std::sqrt(2.0));
}

TEST(RayTraversal, VisitsTheOneCellOfAPoint) {
  std::vector<Visit> visits;
  walk({{-0.01, 3.0}, {-0.01, 3.0}}, 0.5, visits);
  ASSERT_EQ(visits.size(), 1U);
  EXPECT_EQ(visits[0].cell, (Cell{-1, 6}));
  EXPECT_EQ(visits[0].length_m, 0.0);
}

TEST(RayTraversal, VisitsTheSameCellsBackwards) {
  RandomStream random(4, StreamId::kTest);
  std::vector<Visit> there;
  std::vector<Visit> back;
  for (int i = 0; i < 10'000; ++i) {
    const Eigen::Vector2d a(random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0));
    const Eigen::Vector2d b(random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0));
    walk({a, b}, 0.05, there);
    walk({b, a}, 0.05, back);
    ASSERT_EQ(there.size(), back.size());
    for (std::size_t k = 0; k < there.size(); ++k) {
      ASSERT_EQ(there[k].cell, back[back.size() - 1 - k].cell);
      ASSERT_NEAR(there[k].length_m, back[back.size() - 1 - k].length_m, 1e-12);
    }
  }
}

TEST(RayTraversal, StopsWhenTheVisitorSaysSo) {
  int visited = 0;
  traverse_ray({0.5, 0.5}, {9.5, 0.5}, 1.0, [&](const Cell&, double) { return ++visited < 4; });
  EXPECT_EQ(visited, 4);
}

}  // namespace
}  // namespace strata
