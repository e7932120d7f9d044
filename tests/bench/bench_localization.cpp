// SPDX-License-Identifier: Apache-2.0
// One MCL update in the scenario that other localizers were measured in (500 x 500 cells of 0.05 m,
// 360-beam scans to 10 m): motion, weights, resampling and estimate with a fixed number of
// particles on one thread, and the bare kernels beside it.
#include <cmath>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/localization/likelihood_field_kernel.hpp"
#include "core/localization/likelihood_field_model.hpp"
#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/scan/endpoints.hpp"
#include "tests/bench/peers_scenario.hpp"

namespace strata::localization {
namespace {

using bench::fixed_particles;

const bench::PeersScenario& scenario() { return bench::peers_scenario(); }

void update(benchmark::State& state, const std::shared_ptr<const SensorModel>& model) {
  const auto& observations = scenario().observations;
  const auto particles = static_cast<int>(state.range(0));
  Localizer localizer(fixed_particles(particles), model, 1);
  std::size_t n = 0;
  double error = 0.0;
  std::size_t runs = 0;
  for (auto _ : state) {
    if (n == 0) {
      state.PauseTiming();
      localizer.initialize({scenario().truth[0], Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal()});
      state.ResumeTiming();
    }
    benchmark::DoNotOptimize(localizer.update(observations[n]));
    if (++n == observations.size()) {
      error += weighted_error(localizer.particles(), scenario().truth.back());
      ++runs;
      n = 0;
    }
  }
  state.counters["error_m"] = runs > 0 ? error / static_cast<double>(runs) : 0.0;
}

void BM_update_likelihood_field(benchmark::State& state) {
  if (!scenario().found) return state.SkipWithError("no peers_scenario in STRATA_DATA_DIR");
  LikelihoodFieldModelConfig config;
  config.max_beams = static_cast<int>(state.range(1));
  update(state, std::make_shared<LikelihoodFieldModel>(scenario().map, config));
}
BENCHMARK(BM_update_likelihood_field)
    ->Args({500, 60})
    ->Args({1000, 180})
    ->Args({2000, 180})
    ->Args({10000, 180})
    ->Args({100000, 180})
    ->Unit(benchmark::kMillisecond);

void BM_update_beam_model(benchmark::State& state) {
  if (!scenario().found) return state.SkipWithError("no peers_scenario in STRATA_DATA_DIR");
  update(state, make_grid_beam_model(scenario().map));
}
BENCHMARK(BM_update_beam_model)->Args({500, 72})->Args({2000, 72})->Unit(benchmark::kMillisecond);

/// Weights alone. `ns` is per beam and particle.
void weights(benchmark::State& state, bool is_scalar) {
  if (!scenario().found) return state.SkipWithError("no peers_scenario in STRATA_DATA_DIR");
  const auto count = static_cast<std::size_t>(state.range(0));
  const LikelihoodField field(scenario().map, {});
  const Grid<float>& table = field.log_likelihood();
  const Endpoints points = subsample(endpoints_in_robot(scenario().observations[40].scan), 180);
  std::vector<float> px, py, x, y, c, s;
  std::vector<std::uint32_t> sums(count);
  for (std::size_t k = 0; k < points.size(); ++k) {
    px.push_back(static_cast<float>(points.x_m[k] / 0.05));
    py.push_back(static_cast<float>(points.y_m[k] / 0.05));
  }
  RandomStream random(1, StreamId::kTest);
  const Pose2 truth = scenario().truth[40];
  for (std::size_t i = 0; i < count; ++i) {
    const double theta = truth.theta + 0.05 * random.normal();
    x.push_back(static_cast<float>((truth.x + 0.1 * random.normal()) / 0.05));
    y.push_back(static_cast<float>((truth.y + 0.1 * random.normal()) / 0.05));
    c.push_back(static_cast<float>(std::cos(theta)));
    s.push_back(static_cast<float>(std::sin(theta)));
  }
  std::vector<std::uint16_t> steps;
  for (const float value : table.values()) {
    steps.push_back(static_cast<std::uint16_t>(-value * 20000.0F));
  }
  const FieldTable field_table{table.width(), table.height(), steps.data()};
  const FieldPoses poses{x.data(), y.data(), c.data(), s.data(), count};
  const FieldPoints field_points{px.data(), py.data(), px.size()};
  for (auto _ : state) {
    (is_scalar ? sum_field_scalar : sum_field)(field_table, poses, field_points, sums.data());
    benchmark::DoNotOptimize(sums.data());
  }
  state.counters["ns"] = benchmark::Counter(
      static_cast<double>(state.iterations()) * static_cast<double>(count * px.size()) * 1e-9,
      benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
void BM_kernel_simd(benchmark::State& state) { weights(state, false); }
void BM_kernel_scalar(benchmark::State& state) { weights(state, true); }
BENCHMARK(BM_kernel_simd)->Arg(2000)->Arg(10000)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_kernel_scalar)->Arg(2000)->Unit(benchmark::kMicrosecond);

void BM_motion(benchmark::State& state) {
  ParticleSet particles;
  particles.resize(static_cast<std::size_t>(state.range(0)));
  WorkerPool pool(1);
  std::uint64_t step = 0;
  for (auto _ : state) {
    sample_motions({0.1, 0.0, 0.05}, Pose2{}, true, {}, 1, ++step, particles, pool);
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_motion)->Arg(2000)->Unit(benchmark::kMicrosecond);

void BM_resampling(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  RandomStream random(1, StreamId::kTest);
  ParticleSet particles;
  ParticleSet other;
  particles.resize(count);
  other.resize(count);
  for (double& w : particles.weight) w = random.uniform();
  std::vector<std::uint32_t> drawn;
  for (auto _ : state) {
    draw_low_variance(particles.weight, count, 0.5, drawn);
    for (std::size_t i = 0; i < count; ++i) other.copy_from(particles, drawn[i], i);
    benchmark::DoNotOptimize(other.x_m.data());
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BM_resampling)->Arg(2000)->Arg(100000)->Unit(benchmark::kMicrosecond);

void BM_ray_query(benchmark::State& state) {
  if (!scenario().found) return state.SkipWithError("no peers_scenario in STRATA_DATA_DIR");
  const rays::RayCaster caster(scenario().map, 10.0);
  std::size_t n = 0;
  for (auto _ : state) {
    const Pose2& pose = scenario().truth[n % scenario().truth.size()];
    benchmark::DoNotOptimize(caster.expected_range_m(pose, 0.7 * static_cast<double>(n % 360)));
    ++n;
  }
}
BENCHMARK(BM_ray_query);

}  // namespace
}  // namespace strata::localization
