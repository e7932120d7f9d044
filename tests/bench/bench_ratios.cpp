// SPDX-License-Identifier: Apache-2.0
/// Hot loops against the bare form of the same loop on the same machine in the same run.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/grid/distance_field.hpp"
#include "core/grid/likelihood_field.hpp"
#include "core/grid/ray_traversal.hpp"
#include "core/localization/likelihood_field_model.hpp"
#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/random/stream.hpp"
#include "core/scan/endpoints.hpp"
#include "tests/bench/limits/limits.hpp"
#include "tests/bench/peers_scenario.hpp"
#include "tests/bench/ratios.hpp"
#include "tests/bench/scenario_clouds.hpp"

namespace strata {
namespace {

using bench::clouds;
using bench::compare;
using bench::peers_scenario;
using bench::weigh;

/// End points of a scan in cells, at most `most`.
struct CellPoints {
  std::vector<float> x, y;
  explicit CellPoints(const Scan& scan, std::size_t most) {
    const Endpoints points = subsample(endpoints_in_robot(scan), most);
    for (std::size_t k = 0; k < points.size(); ++k) {
      x.push_back(static_cast<float>(points.x_m[k] / 0.05));
      y.push_back(static_cast<float>(points.y_m[k] / 0.05));
    }
  }
  [[nodiscard]] limit::Points points() const { return {x.data(), y.data(), x.size()}; }
};

limit::Field limit_field(const Grid<float>& table) {
  return {table.width(), table.height(), table.values().data()};
}

void place(limit::Particles& particles, const Pose2& pose) {
  RandomStream random(1, StreamId::kTest);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const double theta = pose.theta + 0.05 * random.normal();
    particles.x[i] = static_cast<float>((pose.x + 0.1 * random.normal()) / 0.05);
    particles.y[i] = static_cast<float>((pose.y + 0.1 * random.normal()) / 0.05);
    particles.theta[i] = static_cast<float>(theta);
    particles.cosine[i] = static_cast<float>(std::cos(theta));
    particles.sine[i] = static_cast<float>(std::sin(theta));
  }
}

/// One whole update: motion, weights, resampling, estimate. Arguments: particles, beams.
void update(benchmark::State& state) {
  const auto& scenario = peers_scenario();
  if (!scenario.found) return state.SkipWithError("no peers_scenario in STRATA_DATA_DIR");
  const auto count = static_cast<std::size_t>(state.range(0));
  const auto beams = static_cast<std::size_t>(state.range(1));
  localization::LikelihoodFieldModelConfig config;
  config.max_beams = static_cast<int>(beams);
  const auto model = std::make_shared<localization::LikelihoodFieldModel>(scenario.map, config);
  localization::Localizer localizer(bench::fixed_particles(static_cast<int>(count)), model, 1);
  const LikelihoodField field(scenario.map, {});
  std::vector<CellPoints> points;
  for (const Observation& observation : scenario.observations) {
    points.emplace_back(observation.scan, beams);
  }
  limit::Mcl mcl(count);
  const auto start = [&] {
    localizer.initialize({scenario.truth[0], Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal()});
    localizer.update(scenario.observations[0]);
    place(mcl.particles(), scenario.truth[0]);
  };
  start();
  std::size_t n = 1;
  const auto ours = [&] { benchmark::DoNotOptimize(localizer.update(scenario.observations[n])); };
  const auto bare = [&] {
    const Pose2 motion = between(scenario.observations[n - 1].odom_from_robot,
                                 scenario.observations[n].odom_from_robot);
    const limit::Motion bare_motion{0.0F, static_cast<float>(motion.x / 0.05),
                                    static_cast<float>(motion.theta), 0.02F, 0.4F};
    benchmark::DoNotOptimize(
        mcl.update(bare_motion, limit_field(field.log_likelihood()), points[n].points(), 8.0F));
    if (++n == scenario.observations.size()) {
      n = 1;
      start();
    }
  };
  compare(state, static_cast<double>(count * beams), ours, bare);
}
BENCHMARK(update)->ArgsProduct({{500, 1000, 2000, 10000, 100000}, {60, 180, 360}});

/// The weights alone, per beam and particle.
void weights(benchmark::State& state) {
  const auto& scenario = peers_scenario();
  if (!scenario.found) return state.SkipWithError("no peers_scenario in STRATA_DATA_DIR");
  const auto count = static_cast<std::size_t>(state.range(0));
  const CellPoints points(scenario.observations[40].scan, 180);
  limit::Particles particles(count);
  place(particles, scenario.truth[40]);
  const LikelihoodField field(scenario.map, {});
  const limit::Field bare_field = limit_field(field.log_likelihood());
  std::vector<std::uint16_t> steps;
  for (const float value : field.log_likelihood().values()) {
    steps.push_back(static_cast<std::uint16_t>(-value * 20000.0F));
  }
  const localization::FieldTable table{bare_field.width, bare_field.height, steps.data()};
  std::vector<std::uint32_t> sums(count);
  const auto ours = [&] {
    localization::sum_field(table,
                            {particles.x.data(), particles.y.data(), particles.cosine.data(),
                             particles.sine.data(), count},
                            {points.x.data(), points.y.data(), points.x.size()}, sums.data());
    benchmark::DoNotOptimize(sums.data());
  };
  const bool is_plain = state.range(1) != 0;
  const auto bare = [&] {
    (is_plain ? limit::weigh_plain : limit::weigh_gather)(bare_field, points.points(), particles);
    benchmark::DoNotOptimize(particles.sum.data());
  };
  compare(state, static_cast<double>(count * points.x.size()), ours, bare);
}
BENCHMARK(weights)->ArgNames({"", "plain"})->ArgsProduct({{2000, 100000}, {0, 1}});

/// Rays of 1 to 12 m in all directions, in a map of 26 m: so many that the branch predictor cannot
/// learn them by heart.
std::vector<Eigen::Vector4d> rays() {
  RandomStream random(3, StreamId::kTest);
  std::vector<Eigen::Vector4d> result;
  for (int n = 0; n < 20000; ++n) {
    const double angle = random.uniform(-3.14, 3.14);
    const double range = random.uniform(1.0, 12.0);
    const Eigen::Vector2d from(13.0 + random.uniform(-1.0, 1.0), 13.0 + random.uniform(-1.0, 1.0));
    const Eigen::Vector2d to = from + range * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    result.emplace_back(from.x(), from.y(), to.x(), to.y());
  }
  return result;
}

/// Exact traversal with a sum of lengths and a count per cell; per cell.
void traversal(benchmark::State& state) {
  const auto segments = rays();
  std::vector<limit::Segment> bare_segments;
  for (const Eigen::Vector4d& s : segments) {
    const Eigen::Vector4f cells = (s / 0.05).cast<float>();
    bare_segments.push_back({cells[0], cells[1], cells[2], cells[3]});
  }
  const int width = 540;
  Grid<limit::CellSum> grid(0.05, {{0, 0}, {width, width}});
  std::vector<limit::CellSum> cells(grid.size());
  const auto visited = limit::traverse(bare_segments, width, cells.data());
  const auto ours = [&] {
    for (const Eigen::Vector4d& s : segments) {
      traverse_ray(grid, {s[0], s[1]}, {s[2], s[3]}, [&](std::size_t index, double length_m) {
        limit::CellSum& sum = grid.values()[index];
        sum.length += static_cast<float>(length_m);
        ++sum.count;
      });
    }
    benchmark::ClobberMemory();
  };
  const auto bare = [&] {
    benchmark::DoNotOptimize(limit::traverse(bare_segments, width, cells.data()));
    benchmark::ClobberMemory();
  };
  compare(state, static_cast<double>(visited), ours, bare);
}
BENCHMARK(traversal);

/// Directions of the scenario's beams.
struct Bundle {
  std::vector<double> cosine, sine;
  std::vector<float> cosine_f, sine_f;
  Bundle() {
    for (std::size_t i = 0; i < 360; ++i) {
      const double angle = 0.0174532925 * static_cast<double>(i);
      cosine.push_back(std::cos(angle));
      sine.push_back(std::sin(angle));
      cosine_f.push_back(static_cast<float>(cosine.back()));
      sine_f.push_back(static_cast<float>(sine.back()));
    }
  }
};

/// Ranges of 352 beams from every pose, the bare way.
class BareCaster {
 public:
  explicit BareCaster(const ReflectionGrid& map)
      : distances_(make_distance_field(map)), x_(360), y_(360), ranges_(360) {
    for (float& distance : distances_.values()) distance /= 0.05F;
  }
  void cast(const Pose2& pose, const Bundle& bundle) {
    std::fill(x_.begin(), x_.end(), static_cast<float>(pose.x / 0.05));
    std::fill(y_.begin(), y_.end(), static_cast<float>(pose.y / 0.05));
    limit::cast(limit_field(distances_), x_.data(), y_.data(), bundle.cosine_f.data(),
                bundle.sine_f.data(), 352, 200.0F, ranges_.data());
    benchmark::DoNotOptimize(ranges_.data());
  }

 private:
  Grid<float> distances_;
  std::vector<float> x_, y_, ranges_;
};

/// Expected ranges from the true poses of the scenario, 352 beams each; per ray.
void ray_query(benchmark::State& state) {
  const auto& scenario = peers_scenario();
  if (!scenario.found) return state.SkipWithError("no peers_scenario in STRATA_DATA_DIR");
  const rays::RayCaster caster(scenario.map, 10.0);
  const Bundle bundle;
  BareCaster bare_caster(scenario.map);
  std::vector<double> ranges(352);
  std::vector<std::int32_t> cells(352);
  const auto ours = [&] {
    for (const Pose2& pose : scenario.truth) {
      caster.expected_ranges_m(
          {pose.x, pose.y, 1.0, 0.0, bundle.cosine.data(), bundle.sine.data(), 352, 10.0},
          ranges.data(), cells.data());
      benchmark::DoNotOptimize(ranges.data());
    }
  };
  const auto bare = [&] {
    for (const Pose2& pose : scenario.truth) bare_caster.cast(pose, bundle);
  };
  compare(state, static_cast<double>(352 * scenario.truth.size()), ours, bare);
}
BENCHMARK(ray_query);

/// The beam model, one beam every 5 degrees, per beam and particle; the limit is its ray query.
void beam_model(benchmark::State& state) {
  const auto& scenario = peers_scenario();
  if (!scenario.found) return state.SkipWithError("no peers_scenario in STRATA_DATA_DIR");
  const auto model = localization::make_grid_beam_model(scenario.map);
  auto sets = clouds();
  const double pairs = weigh(*model, sets);
  const Bundle bundle;
  BareCaster bare_caster(scenario.map);
  const auto bundles = static_cast<std::size_t>(pairs / 352.0);
  const auto bare = [&] {
    for (std::size_t n = 0; n < bundles; ++n) {
      bare_caster.cast(scenario.truth[n % scenario.truth.size()], bundle);
    }
  };
  compare(
      state, pairs, [&] { weigh(*model, sets); }, bare);
}
BENCHMARK(beam_model);

}  // namespace
}  // namespace strata
