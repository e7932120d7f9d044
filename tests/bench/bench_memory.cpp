// SPDX-License-Identifier: Apache-2.0
/// Timescale memory: decoding, update and casting beams. The dense case is 360 angle bins x 20
/// range bins with samples in every one, so that all 20 starts and all edges are possible.
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <benchmark/benchmark.h>

#include "core/random/stream.hpp"
#include "memory/decoding/decode.hpp"
#include "memory/decoding/graph.hpp"
#include "memory/nodes/timescale_memory.hpp"
#include "memory/store/store.hpp"
#include "tests/memory/decoding/textbook_dijkstra.hpp"

namespace strata::memory {
namespace {

constexpr int kRows = 360;

/// `starts` states a row, all edges.
LayeredGraph dense_graph(std::size_t starts) {
  RandomStream random(1, StreamId::kTest);
  LayeredGraph graph;
  std::vector<std::uint8_t> states(starts);
  for (std::size_t i = 0; i < starts; ++i) states[i] = static_cast<std::uint8_t>(i);
  for (int row = 0; row < kRows; ++row) graph.add_row(states);
  graph.finish_rows();
  for (double& cost : graph.start_cost()) cost = random.uniform(1.0, 5.0);
  for (std::size_t row = 0; row < graph.rows(); ++row) {
    for (std::size_t i = 0; i < starts; ++i) {
      for (std::size_t j = 0; j < starts; ++j) graph.edge(row, i, j) = random.uniform(1.0, 5.0);
    }
  }
  return graph;
}

void search_dense_layered(benchmark::State& state) {
  const LayeredGraph graph = dense_graph(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(search_layered(graph).cost);
}
BENCHMARK(search_dense_layered)->Arg(20)->Arg(21)->Arg(51)->Unit(benchmark::kMicrosecond);

void search_dense_dijkstra(benchmark::State& state) {
  const LayeredGraph graph = dense_graph(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(search_dijkstra(graph).cost);
}
BENCHMARK(search_dense_dijkstra)->Arg(20)->Unit(benchmark::kMicrosecond);

void search_dense_textbook(benchmark::State& state) {
  const LayeredGraph graph = dense_graph(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(textbook::search_dijkstra(graph).cost);
}
BENCHMARK(search_dense_textbook)->Arg(20)->Unit(benchmark::kMicrosecond);

/// A corridor 3 m wide and 30 m long, with a box for every second scan.
PosedScan corridor_scan(const Pose2& map_from_robot, int t, int beams = 360) {
  PosedScan posed;
  posed.map_from_robot = map_from_robot;
  posed.scan.stamp = Stamp::from_seconds(t);
  posed.scan.angle_min_rad = static_cast<float>(-std::numbers::pi);
  posed.scan.angle_increment_rad = static_cast<float>(2.0 * std::numbers::pi / beams);
  posed.scan.range_max_m = 20.0F;
  RandomStream random(2, StreamId::kTest, static_cast<std::uint64_t>(t));
  for (std::size_t i = 0; i < static_cast<std::size_t>(beams); ++i) {
    const double angle = map_from_robot.theta + posed.scan.bearing_rad(i);
    const double s = std::sin(angle);
    const double c = std::cos(angle);
    const double side = ((s > 0.0 ? 1.5 : -1.5) - map_from_robot.y) / s;
    double range = std::min(std::abs(side), 20.0);
    if (t % 2 == 0 && std::abs(s) < 0.25 && c > 0.0) range = std::min(range, 2.0 / c);
    posed.scan.ranges_m.push_back(static_cast<float>(range + random.normal(0.0, 0.02)));
  }
  return posed;
}

TimescaleMemory standing(int scans) {
  TimescaleMemory memory({}, 1);
  for (int t = 0; t < scans; ++t) {
    memory.observe(corridor_scan({0.3 * std::sin(0.3 * t), 0.2 * std::cos(0.2 * t), 0.1 * t}, t));
  }
  return memory;
}

void decode_level(benchmark::State& state) {
  const TimescaleMemory memory = standing(2000);
  const NodeLevel& level = memory.nodes()[0].levels[static_cast<std::size_t>(state.range(0))];
  for (auto _ : state) benchmark::DoNotOptimize(decode(level, scene_decoding()).cost);
}
BENCHMARK(decode_level)->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMicrosecond);

void decode_level_exactly(benchmark::State& state) {
  const TimescaleMemory memory = standing(2000);
  const NodeLevel& level = memory.nodes()[0].levels[static_cast<std::size_t>(state.range(0))];
  for (auto _ : state) benchmark::DoNotOptimize(decode(level, exact_decoding()).cost);
}
BENCHMARK(decode_level_exactly)->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMicrosecond);

void decode_level_as_the_paper(benchmark::State& state) {
  const TimescaleMemory memory = standing(2000);
  const NodeLevel& level = memory.nodes()[0].levels[static_cast<std::size_t>(state.range(0))];
  for (auto _ : state) benchmark::DoNotOptimize(decode(level, paper_decoding()).cost);
}
BENCHMARK(decode_level_as_the_paper)->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMicrosecond);

void observe_taken(benchmark::State& state) {
  TimescaleMemory memory({}, 1);
  std::vector<PosedScan> scans;
  const int beams = static_cast<int>(state.range(0));
  for (int t = 0; t < 64; ++t) scans.push_back(corridor_scan({0.2, 0.1, 0.1 * t}, t, beams));
  std::int64_t second = 0;
  for (auto _ : state) {
    PosedScan& scan = scans[static_cast<std::size_t>(second % 64)];
    scan.scan.stamp = {++second * 1'000'000'000};
    benchmark::DoNotOptimize(memory.observe(scan).node);
  }
}
BENCHMARK(observe_taken)->Arg(360)->Arg(1080)->Unit(benchmark::kMicrosecond);

/// One update of a particle filter: 1,000 particles x 36 beams. Argument: whether the beams of a
/// particle are cast together, or each for itself.
void expected_ranges(benchmark::State& state) {
  const auto map = standing(2000).decode();
  RandomStream random(3, StreamId::kTest);
  std::vector<Pose2> particles;
  for (int i = 0; i < 1000; ++i) {
    particles.push_back({random.normal(0.0, 0.4), random.normal(0.0, 0.4), random.uniform(-3, 3)});
  }
  std::vector<Eigen::Vector2d> beams;
  for (int i = 0; i < 36; ++i) {
    beams.emplace_back(std::cos(-1.57 + 0.087 * i), std::sin(-1.57 + 0.087 * i));
  }
  std::vector<Eigen::Vector2d> directions(beams.size());
  std::vector<memory::NodeOutline::Reach> reach(beams.size());
  const bool together = state.range(0) != 0;
  for (auto _ : state) {
    for (const Pose2& particle : particles) {
      const NodeMap::View view = map->view(2, particle.translation());
      const Eigen::Rotation2D<double> turn(particle.theta);
      for (std::size_t i = 0; i < beams.size(); ++i) directions[i] = turn * beams[i];
      if (together) {
        map->reach(view, directions, reach);
      } else {
        for (std::size_t i = 0; i < beams.size(); ++i) reach[i] = map->reach(view, directions[i]);
      }
      benchmark::DoNotOptimize(reach.data());
    }
  }
  state.SetItemsProcessed(state.iterations() * 36'000);
}
BENCHMARK(expected_ranges)->ArgName("together")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

/// A store of 10,000 full nodes, the same node again and again, each at its own place.
class LargeStore {
 public:
  static constexpr std::size_t kNodes = 10'000;
  LargeStore() : path_(std::filesystem::temp_directory_path() / "strata_bench_memory.db") {
    remove();
    const TimescaleMemory one = standing(1000);
    std::vector<std::byte> head = one.head_state();
    std::memcpy(head.data() + head.size() - sizeof kNodes, &kNodes, sizeof kNodes);
    std::vector<TimescaleMemory::NodeState> states(kNodes, one.node_state(0));
    for (std::size_t n = 0; n < kNodes; ++n) {
      const std::size_t row = n / 100;
      const double place[2] = {20.0 * static_cast<double>(n % 100),
                               20.0 * static_cast<double>(row)};
      std::memcpy(states[n].head.data(), place, sizeof place);
    }
    Store(path_).save_timescale(TimescaleMemory::restore(head, states, "bench"));
  }
  ~LargeStore() { remove(); }
  LargeStore(const LargeStore&) = delete;
  LargeStore& operator=(const LargeStore&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  void remove() const {
    for (const char* end : {"", "-wal", "-shm"}) std::filesystem::remove(path_.string() + end);
  }
  std::filesystem::path path_;
};

const LargeStore& large_store() {
  static const LargeStore store;
  return store;
}

/// Until the first scan is in: open, all heads, the one node that it is for.
void open_10000_nodes(benchmark::State& state) {
  const std::filesystem::path& path = large_store().path();
  const PosedScan scan = corridor_scan({0.2, 0.1, 0.0}, 5000);
  for (auto _ : state) {
    const Store store(path, {.check = false});
    TimescaleMemory memory = store.open_timescale();
    benchmark::DoNotOptimize(memory.observe(scan).node);
  }
  state.counters["file_MB"] = 1e-6 * static_cast<double>(std::filesystem::file_size(path));
}
BENCHMARK(open_10000_nodes)->Unit(benchmark::kMillisecond);

/// What a localizer needs of a whole building: every level of every node, decoded.
void decode_10000_nodes(benchmark::State& state) {
  const Store store(large_store().path(), {.check = false});
  const TimescaleMemory memory = store.open_timescale();
  for (auto _ : state) benchmark::DoNotOptimize(memory.decode()->nodes().size());
}
BENCHMARK(decode_10000_nodes)->Unit(benchmark::kMillisecond)->Iterations(1);

/// One second of a live component in such a building: some scans, one saved change, one snapshot.
void second_among_10000_nodes(benchmark::State& state) {
  Store store(large_store().path(), {.check = false});
  TimescaleMemory memory = store.open_timescale();
  SavedTimescale saved = Store::all_saved(memory);
  auto map = memory.decode({}, nullptr, 0.0, 100);
  int second = 6000;
  for (auto _ : state) {
    memory.observe(corridor_scan({0.2, 0.1, 0.0}, ++second));
    store.save_timescale_changes(memory, saved);
    memory.evict(500, store.timescale_nodes());
    map = memory.decode({}, map.get(), 0.0, 100);
  }
}
BENCHMARK(second_among_10000_nodes)->Unit(benchmark::kMillisecond);

/// One second of strata::TimescaleMemory's work with a scanner of 40 Hz and 1,080 beams in a
/// corridor of 100 nodes, without the bus: every scan offered, what changed saved twice, one
/// snapshot, and what each level expects of one scan. Allowed: 100 ms, a tenth of a core.
void second_at_40_hz(benchmark::State& state) {
  const auto scan_at = [](double x_m, std::int64_t stamp_ns, int k) {
    PosedScan posed = corridor_scan({0.0, 0.1, 0.01 * k}, k);
    posed.map_from_robot.x = x_m;
    posed.scan.stamp = {stamp_ns};
    posed.scan.angle_increment_rad /= 3.0F;
    std::vector<float> fine;
    for (const float range_m : posed.scan.ranges_m) fine.insert(fine.end(), 3, range_m);
    posed.scan.ranges_m = fine;
    return posed;
  };
  const auto path = std::filesystem::temp_directory_path() / "strata_bench_second.db";
  std::filesystem::remove(path);
  Store store(path);
  SavedTimescale saved;
  TimescaleMemory memory({}, 1);
  std::int64_t now_ns = 0;
  for (int i = 0; i < 2000; ++i) memory.observe(scan_at(0.05 * i, now_ns += 1'000'000'000, i));
  store.save_timescale_changes(memory, saved);
  auto map = memory.decode();
  std::vector<PosedScan> second;
  for (int k = 0; k < 40; ++k) second.push_back(scan_at(0.0, 0, k));
  std::vector<double> bearings_rad;
  for (std::size_t i = 0; i < 1080; ++i) bearings_rad.push_back(second[0].scan.bearing_rad(i));
  std::vector<float> expected_m(bearings_rad.size());
  double x_m = 0.0;
  for (auto _ : state) {
    for (int k = 0; k < 40; ++k) {
      PosedScan& scan = second[static_cast<std::size_t>(k)];
      scan.map_from_robot.x = x_m += 0.7 / 40;  // 0.7 m/s
      scan.scan.stamp = {now_ns += 25'000'000};
      benchmark::DoNotOptimize(memory.observe(scan).node);
      if (k % 20 == 0) store.save_timescale_changes(memory, saved);
    }
    map = memory.decode({}, map.get());
    for (int level = 0; level < 3; ++level) {
      map->expected_ranges_m(level, second[0].map_from_laser(), bearings_rad, expected_m);
    }
    benchmark::DoNotOptimize(expected_m.data());
    if (x_m > 90.0) x_m = 0.0;
  }
  state.counters["nodes"] = static_cast<double>(memory.nodes().size());
}
BENCHMARK(second_at_40_hz)->Unit(benchmark::kMillisecond);

void level_map(benchmark::State& state) {
  const auto map = standing(200).decode();
  for (auto _ : state) benchmark::DoNotOptimize(map->level_map(2).size());
}
BENCHMARK(level_map)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace strata::memory
