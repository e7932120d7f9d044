// SPDX-License-Identifier: Apache-2.0
#include "core/localization/global_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "core/localization/block_kernel.hpp"
#include "core/localization/place_ranking.hpp"
#include "core/localization/range_provider_model.hpp"
#include "tests/core/localization/box_world.hpp"
#include "tests/support/every_target.hpp"

namespace strata::localization {
namespace {

using test::BoxWorld;

/// A room of 8 m by 6 m whose corner of the map is at negative cells, with things that break every
/// symmetry.
BoxWorld odd_room() {
  return {{-3.0, -2.0, 5.0, -1.8}, {-3.0, 3.8, 5.0, 4.0}, {-3.0, -2.0, -2.8, 4.0},
          {4.8, -2.0, 5.0, 4.0},   {0.0, -1.8, 0.7, 0.1}, {3.2, 2.5, 4.8, 2.9},
          {-1.6, 1.9, -1.0, 2.2}};
}

ReflectionGrid map_of_odd_room() {
  return test::rasterize(odd_room(), 0.05, {{-61, -43}, {103, 82}});
}

Scan scan_of_odd_room(const Pose2& robot, RandomStream& random) {
  return test::make_scan(odd_room(), robot, 10.0, 120, 0.01, random, 0.0);
}

Pose2 drawn_pose(RandomStream& random) {
  return {random.uniform(1.0, 3.0), random.uniform(-1.0, 2.2), random.uniform(-3.1, 3.1)};
}

std::vector<GlobalSearch::LatticePlace> try_everything(const GlobalSearch& search,
                                                       const Endpoints& points) {
  const GlobalSearchConfig& config = search.config();
  const int side = 1 << config.levels;
  const int headings = search.headings(points);
  const auto better = [](const auto& a, const auto& b) {
    return std::tuple(b.steps, a.heading, a.square.y, a.square.x) <
           std::tuple(a.steps, b.heading, b.square.y, b.square.x);
  };
  std::vector<GlobalSearch::LatticePlace> blocks;
  std::uint32_t best = 0;
  for (int heading = 0; heading < headings; ++heading) {
    const std::vector<std::uint32_t> steps = search.steps_at(points, heading);
    for (int y = 0; y < search.squares_y(); y += side) {
      for (int x = 0; x < search.squares_x(); x += side) {
        GlobalSearch::LatticePlace block{heading, {}, 0};
        for (int v = y; v < y + side; ++v) {
          for (int u = x; u < x + side; ++u) {
            if (!search.is_open({u, v})) continue;
            const GlobalSearch::LatticePlace place{
                heading, {u, v}, steps[static_cast<std::size_t>(v * search.squares_x() + u)]};
            if (place.steps > 0 && (block.steps == 0 || better(place, block))) block = place;
          }
        }
        if (block.steps == 0) continue;
        best = std::max(best, block.steps);
        blocks.push_back(block);
      }
    }
  }
  std::sort(blocks.begin(), blocks.end(), better);
  std::vector<GlobalSearch::LatticePlace> apart;
  const double turn = 2.0 * std::numbers::pi / headings;
  for (const auto& place : blocks) {
    if (place.steps < config.min_share * best) break;
    if (apart.size() >= static_cast<std::size_t>(config.max_candidates)) break;
    const bool is_alone = std::none_of(apart.begin(), apart.end(), [&](const auto& other) {
      return 0.1 * std::hypot(place.square.x - other.square.x, place.square.y - other.square.y) <
                 config.separation_m &&
             std::abs(wrap_angle(turn * (place.heading - other.heading))) < config.separation_rad;
    });
    if (is_alone) apart.push_back(place);
  }
  return apart;
}

TEST(GlobalSearch, FindsThePlacesThatTryingEveryPlaceFinds) {
  const ReflectionGrid map = map_of_odd_room();
  RandomStream random(3, StreamId::kTest);
  for (const int levels : {0, 1, 2, 3}) {
    GlobalSearchConfig config;
    config.levels = levels;
    config.max_points = 12;
    config.min_share = 0.6;
    const GlobalSearch search(map, config);
    const Endpoints points =
        spread_out(endpoints_in_robot(scan_of_odd_room(drawn_pose(random), random)), 0.1, 12);
    const auto found = search.search_lattice(points);
    const auto expected = try_everything(search, points);
    ASSERT_GT(expected.size(), 3U) << levels;
    ASSERT_EQ(found.size(), expected.size()) << levels;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].heading, expected[i].heading) << levels << ", " << i;
      EXPECT_EQ(found[i].square, expected[i].square) << levels << ", " << i;
      EXPECT_EQ(found[i].steps, expected[i].steps) << levels << ", " << i;
    }
  }
}

TEST(GlobalSearch, FindsTheRobotFromOneScanAndSaysByHowMuch) {
  const ReflectionGrid map = map_of_odd_room();
  const GlobalSearch search(map);
  BeamModelConfig beams;
  beams.tempering = 1.0;
  const auto model = make_grid_beam_model(map, beams);
  WorkerPool pool(1);
  RandomStream random(4, StreamId::kTest);
  for (int n = 0; n < 20; ++n) {
    const Pose2 truth = drawn_pose(random);
    const Scan scan = scan_of_odd_room(truth, random);
    const auto candidates =
        search.search(spread_out(endpoints_in_robot(scan), 0.1, static_cast<std::size_t>(120)));
    const auto places = rank_places(candidates, scan, *model, {}, pool);
    ASSERT_FALSE(places.empty());
    EXPECT_LT(translation_distance(places.front().map_from_robot, truth), 0.1) << n;
    EXPECT_LT(std::abs(wrap_angle(places.front().map_from_robot.theta - truth.theta)), 0.03) << n;
    EXPECT_GT(margin_of(places, 1.0, 0.26), 5.0) << n;
  }
}

TEST(GlobalSearch, LeavesTwoRoomsThatLookAlikeUndecided) {
  // The same room twice, back to back.
  BoxWorld world = odd_room();
  for (const test::Box& box : odd_room()) {
    world.push_back({box.x0 + 8.0, box.y0, box.x1 + 8.0, box.y1});
  }
  const ReflectionGrid map = test::rasterize(world, 0.05, {{-61, -43}, {263, 82}});
  const GlobalSearch search(map);
  const auto model = make_grid_beam_model(map);
  WorkerPool pool(1);
  RandomStream random(5, StreamId::kTest);
  const Pose2 truth{2.0, 1.0, 0.7};
  const Scan scan = test::make_scan(world, truth, 10.0, 120, 0.01, random, 0.0);
  const auto places = rank_places(search.search(endpoints_in_robot(scan)), scan, *model, {}, pool);
  ASSERT_GE(places.size(), 2U);
  EXPECT_LT(margin_of(places, 1.0, 0.26), 3.0);
  const bool is_either_first =
      translation_distance(places[0].map_from_robot, truth) < 0.1 ||
      translation_distance(places[0].map_from_robot, {truth.x + 8.0, truth.y, truth.theta}) < 0.1;
  EXPECT_TRUE(is_either_first);
}

TEST(GlobalSearch, HasNothingToSayOfAScanWithoutHitsOrAMapWithoutCells) {
  const GlobalSearch search(map_of_odd_room());
  EXPECT_TRUE(search.search({}).empty());
  const GlobalSearch nowhere{ReflectionGrid()};
  RandomStream random(6, StreamId::kTest);
  const Endpoints points = endpoints_in_robot(scan_of_odd_room({2.0, 1.0, 0.0}, random));
  EXPECT_TRUE(nowhere.search(points).empty());
  EXPECT_EQ(margin_of({}, 1.0, 0.26), 0.0);
}

TEST(GlobalSearch, RefusesSettingsThatFitNothing) {
  GlobalSearchConfig config;
  config.levels = 7;
  EXPECT_THROW(GlobalSearch(map_of_odd_room(), config), ConfigError);
}

TEST(BlockKernel, EverySimdTargetGivesTheNumbersOfTheScalarReference) {
  RandomStream random(7, StreamId::kTest);
  for (const std::size_t count : {1, 31, 64, 100}) {
    for (const std::size_t rows : {0, 1, 2, 255, 257}) {
      std::vector<std::vector<std::uint8_t>> values(rows);
      std::vector<const std::uint8_t*> begins;
      for (auto& row : values) {
        row.resize(count + BlockBounds::kSlack);
        for (std::uint8_t& value : row) value = static_cast<std::uint8_t>(random.below(256));
        if (rows == 257) std::fill(row.begin(), row.end(), std::uint8_t{255});
        begins.push_back(row.data());
      }
      std::vector<std::uint16_t> expected(count);
      sum_block_rows_scalar(begins, count, expected.data());
      test::for_every_target([&] {
        std::vector<std::uint16_t> sums(count + BlockBounds::kSlack);
        sum_block_rows(begins, count, sums.data());
        sums.resize(count);
        EXPECT_EQ(sums, expected) << count << ", " << rows;
      });
    }
  }
}

}  // namespace
}  // namespace strata::localization
