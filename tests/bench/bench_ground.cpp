// SPDX-License-Identifier: Apache-2.0
/// Rays, counting, distance fields and the beam filter; docs/benchmarks.md has the figures.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/beam_filter/beam_filter.hpp"
#include "core/beam_filter/online_filter.hpp"
#include "core/grid/count_scans.hpp"
#include "core/grid/distance_field.hpp"
#include "core/grid/ray_traversal.hpp"
#include "core/random/stream.hpp"

namespace strata {
namespace {

constexpr double kResolution_m = 0.05;
constexpr double kHalfRoom_m = 12.0;

/// A scan in a square room of 24 m with pillars of noise: rays of 1 to 12 m, like an office's.
PosedScan room_scan(std::uint64_t step, std::size_t beams) {
  RandomStream random(1, StreamId::kTest, step);
  PosedScan posed;
  posed.map_from_robot = {random.uniform(-6.0, 6.0), random.uniform(-6.0, 6.0),
                          random.uniform(-3.0, 3.0)};
  posed.scan.angle_min_rad = static_cast<float>(-std::numbers::pi / 2.0);
  posed.scan.angle_increment_rad =
      static_cast<float>(std::numbers::pi / static_cast<double>(beams));
  posed.scan.range_max_m = 40.0F;
  const Pose2 laser = posed.map_from_laser();
  for (std::size_t n = 0; n < beams; ++n) {
    const double angle = laser.theta + posed.scan.bearing_rad(n);
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    double range = std::min(((c > 0.0 ? kHalfRoom_m : -kHalfRoom_m) - laser.x) / c,
                            ((s > 0.0 ? kHalfRoom_m : -kHalfRoom_m) - laser.y) / s);
    if (random.bernoulli(0.4)) range *= random.uniform(0.1, 1.0);
    posed.scan.ranges_m.push_back(static_cast<float>(range));
  }
  return posed;
}

std::vector<PosedScan> room_log(std::size_t scans, std::size_t beams) {
  std::vector<PosedScan> log;
  for (std::size_t t = 0; t < scans; ++t) log.push_back(room_scan(t, beams));
  return log;
}

/// Exact traversal alone: adds each length to a float and counts the visit, as the limit of
/// docs/benchmarks.md does.
void traverse_rays(benchmark::State& state) {
  struct Cell4 {
    float length = 0.0F;
    int count = 0;
  };
  Grid<Cell4> grid(kResolution_m, {{-260, -260}, {260, 260}});
  std::vector<Ray> rays;
  const auto log = room_log(64, 361);
  for (const PosedScan& scan : log) {
    for_each_ray(scan.scan, scan.map_from_laser(), {},
                 [&](std::size_t, const Ray& ray) { rays.push_back(ray); });
  }
  std::size_t cells = 0;
  for (auto _ : state) {
    for (const Ray& ray : rays) {
      traverse_ray(ray.from_m, ray.to_m, kResolution_m, [&](const Cell& cell, double length_m) {
        Cell4& entry = grid.at(cell);
        entry.length += static_cast<float>(length_m);
        ++entry.count;
        ++cells;
      });
    }
    benchmark::ClobberMemory();
  }
  const double visited = static_cast<double>(cells);
  state.counters["s_per_ray"] =
      benchmark::Counter(static_cast<double>(rays.size()) * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["s_per_cell"] =
      benchmark::Counter(visited, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(traverse_rays)->Unit(benchmark::kMillisecond);

/// Adding scans of 361 beams to a counting map.
void count_scan(benchmark::State& state) {
  const auto log = room_log(64, 361);
  CountingMap map(kResolution_m);
  for (auto _ : state) {
    for (const PosedScan& scan : log) map.add(scan);
  }
  state.counters["s_per_ray"] =
      benchmark::Counter(64.0 * 361.0 * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(count_scan)->Unit(benchmark::kMillisecond);

/// What strata::BeamFilter does at each scan of 1,080 beams once its window is full: one in, one
/// out, all beams labelled. At 40 Hz there are 25 ms.
void filter_online(benchmark::State& state) {
  const auto log = room_log(64, 1'080);
  beam_filter::OnlineFilter filter({}, {.scans = 40});
  for (const PosedScan& scan : log) filter.add(scan);
  std::size_t next = 0;
  for (auto _ : state) benchmark::DoNotOptimize(filter.add(log[next++ % log.size()]));
}
BENCHMARK(filter_online)->Unit(benchmark::kMillisecond);

/// The map that it publishes now and then; argument: metres of the square's edge.
void online_map(benchmark::State& state) {
  beam_filter::OnlineFilter filter;
  auto log = room_log(64, 1'080);
  for (PosedScan& scan : log) filter.add(scan);
  log.back().map_from_robot.x += static_cast<double>(state.range(0)) - 24.0;
  log.back().map_from_robot.y += static_cast<double>(state.range(0)) - 24.0;
  filter.add(log.back());
  for (auto _ : state) benchmark::DoNotOptimize(filter.map());
}
BENCHMARK(online_map)->Arg(24)->Arg(100)->Unit(benchmark::kMillisecond);

/// Exact distances on a 500 x 500 map.
void distance_field(benchmark::State& state) {
  RandomStream random(2, StreamId::kTest);
  Grid<std::uint8_t> occupied(kResolution_m, {{0, 0}, {500, 500}}, 0);
  for (auto& cell : occupied.values()) cell = random.bernoulli(0.02) ? 1 : 0;
  for (auto _ : state) benchmark::DoNotOptimize(make_distance_field(occupied));
  state.counters["s_per_cell"] =
      benchmark::Counter(250'000.0 * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(distance_field)->Unit(benchmark::kMillisecond);

/// E-step of scans of 180 beams.
void label_scans(benchmark::State& state) {
  auto log = room_log(512, 180);
  WorkerPool pool(1);
  const auto result = beam_filter::filter_at_fixed_poses(log, {}, pool);
  for (auto _ : state) {
    for (const PosedScan& scan : log) {
      benchmark::DoNotOptimize(
          beam_filter::label(scan.scan, scan.map_from_laser(), result.filtered, {}));
    }
  }
  state.counters["s_per_beam"] =
      benchmark::Counter(512.0 * 180.0 * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(label_scans)->Unit(benchmark::kMillisecond);

/// The whole filter on a log of the size of Intel's, 13,631 scans of 180 beams. Argument: threads.
void filter_long_log(benchmark::State& state) {
  auto log = room_log(13'631, 180);
  WorkerPool pool(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(beam_filter::filter_at_fixed_poses(log, {}, pool));
  }
}
BENCHMARK(filter_long_log)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace strata
