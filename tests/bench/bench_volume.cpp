// SPDX-License-Identifier: Apache-2.0
/// Insertion of one cloud beside OctoMap's insertPointCloud, same cloud, same tree as result.
#include <cmath>
#include <numbers>

#include <benchmark/benchmark.h>
#include <octomap/OcTree.h>

#include "core/random/stream.hpp"
#include "core/volume/volume_map.hpp"

namespace {

using strata::volume::Cloud;

/// 100,000 points on the walls of a room of 10 x 9 x 6 m with boxes, on average 4.8 m away.
Cloud bench_cloud(std::uint64_t step) {
  strata::RandomStream random(1, strata::StreamId::kTest, step);
  const Eigen::Vector3d half(5.0, 4.5, 3.0);
  Cloud cloud;
  cloud.map_from_sensor.translation = {0.13, -0.21, 0.04};
  for (int i = 0; i < 100000; ++i) {
    const double azimuth = 2.0 * std::numbers::pi * (i % 1000) / 1000.0;
    const double elevation = -1.0 + 2.0 * (i / 1000) / 99.0;
    const Eigen::Vector3d along(std::cos(azimuth) * std::cos(elevation),
                                std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
    double range = 100.0;
    for (int axis = 0; axis < 3; ++axis) {
      if (along[axis] == 0.0) continue;
      const double wall = along[axis] > 0.0 ? half[axis] : -half[axis];
      range = std::min(range, (wall - cloud.map_from_sensor.translation[axis]) / along[axis]);
    }
    range += random.normal(0.0, 0.01);
    cloud.points_m.push_back((along * range).cast<float>());
  }
  return cloud;
}

// Of one sensor that stands still: the first cloud makes the tree, later ones update it.
constexpr int kClouds = 3;

double resolution(const benchmark::State& state) {
  return static_cast<double>(state.range(0)) / 1000.0;
}

void report(benchmark::State& state, std::size_t nodes) {
  state.counters["nodes"] = static_cast<double>(nodes);
  state.counters["us_per_point"] =
      benchmark::Counter(0.1 * kClouds * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void octomap_insert(benchmark::State& state) {
  octomap::Pointcloud points;
  const Cloud cloud = bench_cloud(0);
  for (const auto& p : cloud.points_m) points.push_back(p.x(), p.y(), p.z());
  const auto t = cloud.map_from_sensor.translation.cast<float>();
  const octomap::pose6d pose(octomap::point3d(t.x(), t.y(), t.z()), octomath::Quaternion());
  std::size_t nodes = 0;
  for (auto _ : state) {
    octomap::OcTree tree(resolution(state));
    for (int i = 0; i < kClouds; ++i) {
      tree.insertPointCloud(octomap::ScanNode(new octomap::Pointcloud(points), pose, 0));
    }
    nodes = tree.size();
  }
  report(state, nodes);
}

void strata_insert(benchmark::State& state) {
  const Cloud cloud = bench_cloud(0);
  strata::WorkerPool pool(static_cast<int>(state.range(1)));
  strata::volume::VolumeConfig config;
  config.resolution_m = resolution(state);
  std::size_t nodes = 0;
  for (auto _ : state) {
    strata::volume::VolumeMap map(config);
    for (int i = 0; i < kClouds; ++i) map.insert(cloud, {}, pool);
    nodes = map.size().nodes;
  }
  report(state, nodes);
}

BENCHMARK(octomap_insert)->Args({100})->Args({50})->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(strata_insert)
    ->Args({100, 1})
    ->Args({100, 2})
    ->Args({50, 1})
    ->Args({50, 2})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
