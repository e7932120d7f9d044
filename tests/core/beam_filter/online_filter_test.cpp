// SPDX-License-Identifier: Apache-2.0
#include "core/beam_filter/online_filter.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/base/state_archive.hpp"
#include "core/grid/count_scans.hpp"
#include "core/grid/grid_state.hpp"
#include "tests/core/scan/corridor_drive.hpp"

namespace strata::beam_filter {
namespace {

constexpr std::size_t kOnlineBeams = 120;
constexpr double kHall_m = 4.0;     // half a square hall
constexpr double kPerson_m = 1.52;  // from the middle
constexpr double kShoulder_rad = 0.15;

/// The middle of a hall, 20 scans a second; a person may stand in the way of some beams at angle 0.
PosedScan from_the_middle(int t, double x_m, bool with_person) {
  PosedScan posed;
  posed.map_from_robot = {x_m, 0.0, 0.0};
  posed.scan.stamp = Stamp::from_seconds(0.05 * t);
  posed.scan.angle_min_rad = static_cast<float>(-std::numbers::pi);
  posed.scan.angle_increment_rad = static_cast<float>(2.0 * std::numbers::pi / kOnlineBeams);
  posed.scan.range_max_m = 20.0F;
  for (std::size_t n = 0; n < kOnlineBeams; ++n) {
    const double angle = posed.scan.bearing_rad(n);
    const double c = std::abs(std::cos(angle)) < 1e-9 ? 1e-9 : std::cos(angle);
    const double s = std::abs(std::sin(angle)) < 1e-9 ? 1e-9 : std::sin(angle);
    double range =
        std::min(((c > 0.0 ? kHall_m : -kHall_m) - x_m) / c, (s > 0.0 ? kHall_m : -kHall_m) / s) +
        0.02;
    if (with_person && std::abs(angle) < kShoulder_rad) range = kPerson_m - x_m;
    posed.scan.ranges_m.push_back(static_cast<float>(range));
  }
  return posed;
}

bool hits_person(const PosedScan& posed, std::size_t beam) {
  return std::abs(posed.scan.bearing_rad(beam)) < kShoulder_rad;
}

TEST(OnlineFilter, LabelsAnUnknownHallStaticAndWhoComesLaterDynamic) {
  OnlineFilter filter;
  for (int t = 0; t < 30; ++t) {
    for (const float e : filter.add(from_the_middle(t, 0.0, false))) EXPECT_GT(e, 0.5F);
  }
  const PosedScan scan = from_the_middle(30, 0.0, true);
  const std::vector<float> labels = filter.add(scan);
  for (std::size_t n = 0; n < kOnlineBeams; ++n) {
    EXPECT_EQ(labels[n] < 0.5F, hits_person(scan, n)) << n;
  }
}

TEST(OnlineFilter, StoppedAndRestoredItLabelsAsIfItHadNeverStopped) {
  const WindowConfig window{.scans = 25};
  OnlineFilter whole({}, window);
  OnlineFilter stopped({}, window);
  for (int t = 0; t < 120; ++t) {
    const PosedScan scan = from_the_middle(t, 0.02 * (t % 60), t % 40 > 20);
    ASSERT_EQ(stopped.add(scan), whole.add(scan)) << t;
    if (t % 17 != 0) continue;
    const std::vector<std::uint8_t> state = stopped.save_state();
    stopped = OnlineFilter({}, window);
    stopped.restore_state(state, "state");
    EXPECT_THROW(OnlineFilter().restore_state(std::span(state).first(state.size() - 1), "state"),
                 InputError);
    BeamFilterConfig coarse;
    coarse.resolution_m = 0.1;
    EXPECT_THROW(OnlineFilter(coarse).restore_state(state, "state"), InputError);
  }
  EXPECT_EQ(stopped.scans_in_window(), 25U);
}

/// As bytes say it that were saved when all scans were counted in one map.
std::vector<std::uint8_t> in_one_map(const std::vector<std::uint8_t>& state,
                                     const CountingMap& keys, const CountingMap& window) {
  const auto bytes_of = [](const auto& value) {
    StateWriter writer;
    writer(value);
    return writer.take();
  };
  CountingMap all = keys;
  all.add(window);
  std::vector<std::uint8_t> before = bytes_of(std::uint64_t{0x53'4f'42'46'0000'0002});
  const std::vector<std::uint8_t> cells = bytes_of(all.cells());
  const std::size_t behind =
      before.size() + bytes_of(window.cells()).size() + bytes_of(keys.cells()).size();
  before.insert(before.end(), cells.begin(), cells.end());
  before.insert(before.end(), state.begin() + static_cast<std::ptrdiff_t>(behind), state.end());
  return before;
}

/// ... when nothing was said of beams without return: no scanner, and of each scan in the window
/// how far it saw and a list without beams. Of a filter that does not ask them.
std::vector<std::uint8_t> without_drop_outs(std::vector<std::uint8_t> state, std::size_t window) {
  state.resize(state.size() - sizeof(std::uint64_t) -
               window * (sizeof(float) + sizeof(std::uint64_t)));
  state[0] = 3;  // the version's last byte
  return state;
}

TEST(OnlineFilter, GoesOnFromAStateWithoutBeamsWithoutReturnAsFromItsOwn) {
  const WindowConfig window{.scans = 25};
  OnlineFilter filter({}, window, {.is_used = false});
  OnlineFilter restored({}, window, {.is_used = false});
  int t = 0;
  for (; t < 60; ++t) filter.add(from_the_middle(t, 0.03 * t, t % 7 == 0));
  restored.restore_state(without_drop_outs(filter.save_state(), 25), "the state");
  for (; t < 90; ++t) {
    const PosedScan scan = from_the_middle(t, 0.03 * (t % 40), t % 3 == 0);
    ASSERT_EQ(restored.add(scan), filter.add(scan)) << t;
  }
}

TEST(OnlineFilter, WhoStoodBeforeOpenSpaceIsGoneFromTheMapAfterwards) {
  const auto stays = [](bool is_used) {
    OnlineFilter filter({}, {.scans = 20}, {.is_used = is_used});
    // Between walls at y = -2 and 2 without an end somebody stands at x = 4.02 for 10 s.
    const test::World with_person = [](double x, double y, double angle, double time_s) {
      const double wall = test::corridor(x, y, angle, time_s);
      const double ahead = (4.02 - x) / std::max(0.1, std::cos(angle));
      const bool is_met = std::abs(y + ahead * std::sin(angle)) < 0.25;
      return time_s < 10.0 && is_met && ahead < wall ? ahead : wall;
    };
    test::Drive drive = test::drive(with_person, test::always(0.002));
    for (const PosedScan& scan : drive.scans) (void)filter.add(scan);
    const ReflectionGrid map = filter.map();
    int cells = 0;
    for (int y = -5; y < 5; ++y) {
      for (int x = 78; x < 82; ++x) {
        const float m = map.get({x, y});
        if (is_known(m) && m > 0.25F) ++cells;
      }
    }
    return cells;
  };
  EXPECT_GT(stays(false), 3);
  EXPECT_EQ(stays(true), 0);
}

TEST(OnlineFilter, GoesOnFromAStateOfOneMapAsFromItsOwn) {
  const WindowConfig window{.scans = 25, .fade_scans = 20.0};
  OnlineFilter filter({}, window, {.is_used = false});
  OnlineFilter restored({}, window, {.is_used = false});
  CountingMap keys(filter.counts().resolution_m());
  CountingMap lately(filter.counts().resolution_m());
  std::vector<PosedScan> others;
  int t = 0;
  for (; t < 60; ++t) {
    const PosedScan scan = from_the_middle(t, 0.03 * t, t % 7 == 0);
    filter.add(scan);
    const bool is_key = t % 4 == 0;  // 0.12 m apart
    if (is_key) keys.add_fading(scan, {}, BeamWeights::kAllStatic, window.fade_scans);
    if (!is_key) lately.add(scan, {}, 1.0, BeamWeights::kAllStatic);
    others.push_back(scan);
    if (t >= 25 && (t - 25) % 4 != 0) {
      lately.add(others[static_cast<std::size_t>(t - 25)], {}, -1.0, BeamWeights::kAllStatic);
    }
  }
  const auto of_two_maps = without_drop_outs(filter.save_state(), 25);
  restored.restore_state(in_one_map(of_two_maps, keys, lately), "the state");
  for (; t < 120; ++t) {
    const PosedScan scan = from_the_middle(t, 0.03 * (t % 40), t % 3 == 0);
    const std::vector<float> expected = filter.add(scan);
    const std::vector<float> labels = restored.add(scan);
    for (std::size_t n = 0; n < kOnlineBeams; ++n) ASSERT_NEAR(labels[n], expected[n], 1e-6F) << t;
  }
  // What the window forgets it takes from its own map.
  const Grid<CellCounts> cells = restored.counts().cells().dense();
  for (const CellCounts& cell : cells.values()) EXPECT_GE(cell.total(), -1e-9);
}

TEST(OnlineFilter, ForgetsWhoStoodBeforeAStandingRobotWithTheWindow) {
  OnlineFilter filter({}, {.scans = 40});
  CountingMap all(filter.counts().resolution_m());
  const Eigen::Vector2d person(kPerson_m, 0.0);
  auto see = [&](int t, bool with_person) {
    const PosedScan scan = from_the_middle(t, 0.0, with_person);
    all.add(scan);
    return filter.add(scan);
  };
  for (int t = 0; t < 200; ++t) see(t, true);
  const ReflectionGrid before = filter.map();
  EXPECT_TRUE(is_occupied(before.get(before.cell_at(person))));
  for (int t = 200; t < 240; ++t) see(t, false);
  const ReflectionGrid after = filter.map();
  EXPECT_TRUE(is_free(after.get(after.cell_at(person))));
  // Counted for ever, she would still stand there.
  const ReflectionGrid for_ever = all.reflection();
  EXPECT_TRUE(is_occupied(for_ever.get(for_ever.cell_at(person))));
  // And who comes back to that place is dynamic now.
  const PosedScan back = from_the_middle(240, 0.0, true);
  const std::vector<float> labels = filter.add(back);
  for (std::size_t n = 0; n < kOnlineBeams; ++n) {
    if (hits_person(back, n)) {
      EXPECT_LT(labels[n], 0.5F);
    }
  }
}

TEST(OnlineFilter, HoldsTheWindowAndTheKeyScansAndNothingElse) {
  const WindowConfig window{.scans = 25, .fade_scans = 1e15};
  OnlineFilter filter({}, window);
  std::vector<PosedScan> kept;
  constexpr int kScans = 300;
  double last_key_m = -1.0;
  for (int t = 0; t < kScans; ++t) {
    const double x_m = 0.003 * t;
    const PosedScan scan = from_the_middle(t, x_m, t % 3 == 0);
    filter.add(scan);
    const bool key = last_key_m < 0.0 || x_m - last_key_m >= window.key_distance_m;
    if (key) last_key_m = x_m;
    if (key || t >= kScans - window.scans) kept.push_back(scan);
  }
  EXPECT_EQ(filter.scans_in_window(), 25U);
  WorkerPool pool(1);
  const CountingMap expected =
      count_scans(kept, filter.counts().resolution_m(), {}, BeamWeights::kAllStatic, pool);
  const CountingMap counts = filter.counts();
  const Grid<CellCounts> cells = counts.cells().dense();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellCounts& other = expected.cells().get(cells.cell(i));
    ASSERT_NEAR(cells.values()[i].hits, other.hits, 1e-9);
    ASSERT_NEAR(cells.values()[i].misses, other.misses, 1e-9);
  }
}

/// Drives a metre and back, 20 key scans, again and again. Something may stand before the wall.
void patrol(OnlineFilter& filter, int times, bool with_cabinet, int& t) {
  for (int i = 0; i < 20 * times; ++i) {
    const int step = i % 20;
    const double x_m = 0.101 * (step < 10 ? step : 20 - step);
    (void)filter.add(from_the_middle(t++, x_m, with_cabinet));
  }
}

/// The share of the beams at the cabinet that are labelled static.
double static_share(OnlineFilter& filter, int& t) {
  const PosedScan scan = from_the_middle(t++, 0.0, true);
  const std::vector<float> labels = filter.add(scan);
  int beams = 0;
  int are_static = 0;
  for (std::size_t n = 0; n < kOnlineBeams; ++n) {
    if (!hits_person(scan, n)) continue;
    ++beams;
    are_static += labels[n] > 0.5F ? 1 : 0;
  }
  return static_cast<double>(are_static) / beams;
}

TEST(OnlineFilter, WhatIsPutUpForGoodBecomesPartOfTheMapAndGoesAgain) {
  OnlineFilter filter({}, {.scans = 20});
  int t = 0;
  patrol(filter, 60, false, t);
  EXPECT_EQ(static_share(filter, t), 0.0);
  patrol(filter, 1, true, t);
  EXPECT_EQ(static_share(filter, t), 0.0) << "who waits for two metres of driving is no wall";
  patrol(filter, 11, true, t);
  EXPECT_EQ(static_share(filter, t), 1.0);
  patrol(filter, 25, false, t);
  const ReflectionGrid map = filter.map();
  EXPECT_TRUE(is_free(map.get(map.cell_at(Eigen::Vector2d(kPerson_m, 0.0)))));
  // Counted for ever, it would be dynamic still.
  OnlineFilter for_ever({}, {.scans = 20, .fade_scans = 1e15});
  t = 0;
  patrol(for_ever, 60, false, t);
  patrol(for_ever, 12, true, t);
  EXPECT_EQ(static_share(for_ever, t), 0.0);
}

TEST(OnlineFilter, RefusesSettingsThatCannotWork) {
  BeamFilterConfig filter;
  filter.prior = 0.5;
  EXPECT_THROW(OnlineFilter{filter}, ConfigError);
  EXPECT_THROW(OnlineFilter({}, {.scans = 0}), ConfigError);
}

}  // namespace
}  // namespace strata::beam_filter
