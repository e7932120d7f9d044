// SPDX-License-Identifier: Apache-2.0
/// Doors within zones in which nothing is learned, or nothing changes.
#include "tools/pipeline/learn_within.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "components/maps/earlier_runs.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/simulate/two_days.hpp"

namespace strata::pipeline {
namespace {

constexpr std::uint64_t kSeed = 7;
constexpr double kCell_m = 0.05;
/// With the whole way of the leaf; the doors of three_doors.yaml.
const CellRect kWest{{44, 38}, {78, 82}};
const CellRect kMiddle{{164, 38}, {198, 82}};
const CellRect kEast{{284, 38}, {318, 82}};

Grid<std::uint8_t> ones(const CellRect& rect) {
  Grid<std::uint8_t> cells(kCell_m, rect, 0);
  std::fill(cells.values().begin(), cells.values().end(), std::uint8_t{1});
  return cells;
}

/// A hall with three doors: closed on the day that the maps were learned on, open on the next.
struct Days {
  Days() : days(test::two_days(STRATA_SCENARIO_DIR "/three_doors.yaml", 101)) {
    const LearnResult first = learn(days.first, days.first_poses, {}, {}, kSeed, 2, nullptr);
    maps::write_grid_maps(folder.path(), first.slam);
    maps::write_timescale(folder.path(), *first.timescale);
    maps::write_summary(folder.path(), "monday", {});
    for (Observation& observation : days.second) observation.run = 1;
    poses.assign(days.second_poses.begin(), days.second_poses.end());
  }
  [[nodiscard]] LearnResult update(const LearnWithin& limits, int threads = 2) const {
    maps::EarlierRuns earlier = maps::read_earlier_runs(folder.path());
    return learn_within(limits, days.second, poses, {}, {}, kSeed, threads, nullptr, &earlier);
  }
  test::TwoDays days;
  std::vector<std::optional<Pose2>> poses;
  test::TemporaryDirectory folder;
};

const Days& days() {
  static const Days made;
  return made;
}

bool has_change_in(const patch::PatchMap& map, const CellRect& rect) {
  return std::any_of(map.submaps.begin(), map.submaps.end(), [&](const patch::Submap& submap) {
    for (int y = rect.min.y; y < rect.max.y; ++y) {
      for (int x = rect.min.x; x < rect.max.x; ++x) {
        if (submap.contradictory.get({x, y}) != 0) return true;
      }
    }
    return false;
  });
}

std::size_t different_cells(const ReflectionGrid& a, const ReflectionGrid& b,
                            const CellRect& rect) {
  std::size_t count = 0;
  for (int y = rect.min.y; y < rect.max.y; ++y) {
    for (int x = rect.min.x; x < rect.max.x; ++x) {
      const float one = a.get({x, y});
      const float other = b.get({x, y});
      count += std::memcmp(&one, &other, sizeof one) != 0 ? 1U : 0U;
    }
  }
  return count;
}

/// In steps of 1 cm, as nobody else does it.
bool touches(const PosedScan& scan, std::size_t beam, const CellRect& rect) {
  const Pose2 laser = scan.map_from_laser();
  const double bearing = laser.theta + scan.scan.bearing_rad(beam);
  for (double r = 0.0; r < static_cast<double>(scan.scan.ranges_m[beam]); r += 0.01) {
    const Eigen::Vector2d at{laser.x + r * std::cos(bearing), laser.y + r * std::sin(bearing)};
    if (rect.contains(cell_at(at, kCell_m))) return true;
  }
  return false;
}

TEST(LearnWithin, IsLearnWhereNoCellIsNamed) {
  maps::EarlierRuns earlier = maps::read_earlier_runs(days().folder.path());
  const LearnResult plain =
      learn(days().days.second, days().poses, {}, {}, kSeed, 2, nullptr, &earlier);
  const LearnResult within = days().update({}, 1);
  EXPECT_EQ(plain.patches.submaps.size(), within.patches.submaps.size());
  EXPECT_EQ(plain.timescale->state(), within.timescale->state());
  for (const CellRect& door : {kWest, kMiddle, kEast}) {
    EXPECT_TRUE(has_change_in(within.patches, door)) << "or nothing below says anything";
    EXPECT_EQ(different_cells(plain.slam.filtered, within.slam.filtered, door), 0U);
  }
}

TEST(LearnWithin, LeavesWhatWasKnownWhereNothingIsToBeLearned) {
  const BaseBefore before = read_base(days().folder.path());
  const LearnResult after = days().update({ones(kWest), {}, before});
  EXPECT_FALSE(has_change_in(after.patches, kWest));
  EXPECT_TRUE(has_change_in(after.patches, kEast));
  EXPECT_EQ(different_cells(before.filtered, after.slam.filtered, kWest), 0U);
  EXPECT_EQ(different_cells(before.occupancy, after.slam.occupancy, kWest), 0U);
  EXPECT_EQ(different_cells(before.filtered, after.patches.base, kWest), 0U);
  EXPECT_GT(different_cells(before.filtered, after.slam.filtered, kEast), 100U);
  for (int y = kWest.min.y; y < kWest.max.y; ++y) {
    for (int x = kWest.min.x; x < kWest.max.x; ++x) {
      const CellCounts& counts = after.slam.raw.cells().get({x, y});
      ASSERT_EQ(counts.hits, before.counts.get({x, y}).hits);
      ASSERT_EQ(counts.misses, before.counts.get({x, y}).misses);
    }
  }
  for (const SurfaceCell& surface : after.slam.surfaces.cells) {
    if (!kWest.contains({surface.x, surface.y})) continue;
    EXPECT_NE(std::find(before.surfaces.cells.begin(), before.surfaces.cells.end(), surface),
              before.surfaces.cells.end());
  }
}

TEST(LearnWithin, ShowsTheMemoryAndLaterUpdatesNoBeamThatSawThere) {
  const LearnResult after = days().update({ones(kWest), {}, read_base(days().folder.path())});
  maps::EarlierRuns earlier = maps::read_earlier_runs(days().folder.path());
  std::size_t blinded = 0;
  std::size_t second = 0;
  for (const PosedScan& scan : after.slam.scans) {
    if (scan.run == 0) continue;
    const std::vector<float>& measured = days().days.second[second++].scan.ranges_m;
    for (std::size_t i = 0; i < scan.scan.size(); ++i) {
      const bool is_taken = std::isnan(scan.scan.ranges_m[i]) && !std::isnan(measured[i]);
      blinded += is_taken ? 1U : 0U;
      if (!std::isfinite(scan.scan.ranges_m[i])) continue;
      ASSERT_FALSE(touches(scan, i, kWest)) << second << ", beam " << i;
    }
    earlier.timescale->observe(scan);
  }
  EXPECT_GT(blinded, 1000U);
  EXPECT_LT(blinded, second * 90) << "most beams are elsewhere";
  earlier.timescale->close_day();
  EXPECT_EQ(after.timescale->state(), earlier.timescale->state());
}

TEST(LearnWithin, LearnsTheMapButNoChangeWhereOnlyWhatIsStaticCounts) {
  const BaseBefore before = read_base(days().folder.path());
  const LearnResult after = days().update({{}, ones(kMiddle), before});
  EXPECT_FALSE(has_change_in(after.patches, kMiddle));
  EXPECT_TRUE(has_change_in(after.patches, kWest));
  EXPECT_TRUE(has_change_in(after.patches, kEast));
  EXPECT_GT(different_cells(before.filtered, after.slam.filtered, kMiddle), 100U);
  for (std::size_t s = 0; s < after.patches.submaps.size(); ++s) {
    const patch::Submap& submap = after.patches.submaps[s];
    EXPECT_EQ(submap.id, static_cast<int>(s));
    for (const patch::Configuration& one : submap.configurations) {
      EXPECT_EQ(
          different_cells(one.reflection, after.patches.base, kMiddle.intersected(submap.rect)),
          0U);
    }
  }
}

TEST(LearnWithin, HoldsAPartOfAnAreaThatChangesStill) {
  const CellRect half{kEast.min, {301, kEast.max.y}};  // to the middle of the opening
  const CellRect rest{{301, kEast.min.y}, kEast.max};
  const LearnResult after = days().update({{}, ones(half), read_base(days().folder.path())});
  EXPECT_FALSE(has_change_in(after.patches, half));
  ASSERT_TRUE(has_change_in(after.patches, rest));
  std::size_t shared = 0;
  for (const patch::Submap& submap : after.patches.submaps) {
    const CellRect both = half.intersected(submap.rect);
    shared += both.area();
    for (const patch::Configuration& one : submap.configurations) {
      EXPECT_EQ(different_cells(one.reflection, after.patches.base, both), 0U);
    }
  }
  EXPECT_GT(shared, 20U) << "or nothing is held";
}

/// The room behind the east door, that door, and the floor before it.
const CellRect kEastRoom{{260, 0}, {360, 120}};

/// Of all cells of the map but those of a region.
std::size_t different_outside(const ReflectionGrid& a, const ReflectionGrid& b,
                              const CellRect& region) {
  const CellRect all = a.rect().united(b.rect());
  return different_cells(a, b, all) - different_cells(a, b, region);
}

TEST(LearnWithin, LearnsInTheRegionThatIsNamedAlone) {
  const BaseBefore before = read_base(days().folder.path());
  const LearnResult after = days().update({{}, {}, before, ones(kEastRoom)});
  EXPECT_TRUE(has_change_in(after.patches, kEast));
  EXPECT_FALSE(has_change_in(after.patches, kWest));
  EXPECT_FALSE(has_change_in(after.patches, kMiddle));
  EXPECT_GT(different_cells(before.filtered, after.slam.filtered, kEast), 100U);
  EXPECT_EQ(different_outside(before.filtered, after.slam.filtered, kEastRoom), 0U);
  EXPECT_EQ(different_outside(before.occupancy, after.slam.occupancy, kEastRoom), 0U);
  const LearnResult never =
      days().update({ones({{270, 0}, {300, 120}}), {}, before, ones(kEastRoom)});
  EXPECT_FALSE(has_change_in(never.patches, kEast)) << "a zone in the region holds still";
}

TEST(LearnWithin, ForgetsWhatEarlierRunsSawOfARegionThatWasRebuilt) {
  const BaseBefore before = read_base(days().folder.path());
  const LearnResult after = days().update({{}, {}, before, ones(kEastRoom), true});
  EXPECT_FALSE(has_change_in(after.patches, kEast)) << "it has only ever been open";
  EXPECT_EQ(different_outside(before.filtered, after.slam.filtered, kEastRoom), 0U);
  EXPECT_EQ(different_outside(before.occupancy, after.slam.occupancy, kEastRoom), 0U);
  const LearnResult both = days().update({{}, {}, before, ones(kEastRoom)});
  const auto beams_in = [](const LearnResult& result, const CellRect& rect) {
    std::uint64_t beams = 0;
    for (int y = rect.min.y; y < rect.max.y; ++y) {
      for (int x = rect.min.x; x < rect.max.x; ++x) {
        const CellCounts& counts = result.slam.raw.cells().get({x, y});
        beams += counts.hits + counts.misses;
      }
    }
    return beams;
  };
  EXPECT_LT(beams_in(after, kEast), beams_in(both, kEast) * 2 / 3);
  EXPECT_GT(beams_in(after, kEast), 1000U) << "the new run's";
  for (const PosedScan& scan : after.slam.scans) {
    if (scan.run > 0) continue;
    for (std::size_t i = 0; i < scan.scan.size(); ++i) {
      if (!std::isfinite(scan.scan.ranges_m[i])) continue;
      ASSERT_FALSE(touches(scan, i, kEastRoom)) << "later updates would see it again";
    }
  }
}

TEST(LearnWithin, KeepsWhatLiesBehindARegionThatIsForgotten) {
  std::vector<Observation> west;
  std::vector<std::optional<Pose2>> poses;
  for (std::size_t i = 0; i < days().days.first.size(); ++i) {
    if (days().days.first_poses[i]->x > 5.0) continue;
    west.push_back(days().days.first[i]);
    poses.push_back(days().days.first_poses[i]);
  }
  const LearnParts none{.patch = false, .timescale = false};
  const LearnResult seen = learn(west, poses, {}, none, kSeed, 2, nullptr);
  test::TemporaryDirectory folder;
  maps::write_grid_maps(folder.path(), seen.slam);
  maps::EarlierRuns earlier = maps::read_earlier_runs(folder.path());
  const BaseBefore before = read_base(folder.path());
  const CellRect across{{120, -50}, {130, 250}};
  const LearnResult after = learn_within({{}, {}, before, ones(across), true}, {}, {}, {}, none,
                                         kSeed, 2, nullptr, &earlier);
  EXPECT_GT(different_cells(before.filtered, after.slam.filtered, across), 100U) << "forgotten";
  EXPECT_EQ(different_outside(before.filtered, after.slam.filtered, across), 0U);
  EXPECT_EQ(different_outside(before.occupancy, after.slam.occupancy, across), 0U);
  for (std::size_t i = 0; i < before.counts.size(); ++i) {
    const Cell cell = before.counts.cell(i);
    if (across.contains(cell)) continue;
    ASSERT_EQ(after.slam.raw.cells().get(cell).misses, before.counts.values()[i].misses);
    ASSERT_EQ(after.slam.raw.cells().get(cell).hits, before.counts.values()[i].hits);
  }
}

TEST(LearnWithin, RefusesCellsOfAnotherSizeThanTheMapsBefore) {
  maps::LearnConfig config;
  config.slam.beam_filter.resolution_m = 0.1;
  const LearnWithin limits{{}, {}, read_base(days().folder.path()), ones(kEastRoom)};
  EXPECT_THROW((void)learn_within(limits, {}, {}, config, {}, kSeed, 1, nullptr, nullptr),
               InputError);
}

TEST(LearnWithin, RefusesARegionThatHoldsNoCellOrTheWholeWorld) {
  const auto square = [](double size) {
    return std::vector<MetricPolygon>{{{{0, 0}, {size, 0}, {size, size}, {0, size}}, {}}};
  };
  EXPECT_EQ(cells_of_region(square(1.0), kCell_m, "r").size(), 400U);
  EXPECT_THROW((void)cells_of_region(square(0.01), kCell_m, "r"), InputError);
  EXPECT_THROW((void)cells_of_region(square(2000.0), kCell_m, "r"), InputError);
}

}  // namespace
}  // namespace strata::pipeline
