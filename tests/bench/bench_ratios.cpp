// SPDX-License-Identifier: Apache-2.0
/// Hot loops against the bare form of the same loop on the same machine in the same run: each
/// iteration runs both, and `ratio` is the median of the quotients of their CPU times.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/grid/distance_field.hpp"
#include "core/grid/likelihood_field.hpp"
#include "core/grid/ray_traversal.hpp"
#include "core/localization/likelihood_field_model.hpp"
#include "core/localization/localizer.hpp"
#include "core/localization/patch_beam_model.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/random/stream.hpp"
#include "core/scan/endpoints.hpp"
#include "tests/bench/limits/limits.hpp"
#include "tests/bench/peers_scenario.hpp"

namespace strata {
namespace {

using bench::peers_scenario;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <typename Body>
double seconds_of(Body&& body) {
  const double begin = cpu_seconds();
  body();
  return cpu_seconds() - begin;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// items: what `ours` and `limit` do at a time; figures are nanoseconds for one.
template <typename Ours, typename Limit>
void compare(benchmark::State& state, double items, Ours&& ours, Limit&& limit) {
  std::vector<double> a;
  std::vector<double> b;
  std::vector<double> ratios;
  for (auto _ : state) {
    a.push_back(seconds_of(ours));
    b.push_back(seconds_of(limit));
    ratios.push_back(a.back() / b.back());
  }
  state.counters["ours_ns"] = median(std::move(a)) / items * 1e9;
  state.counters["limit_ns"] = median(std::move(b)) / items * 1e9;
  state.counters["ratio"] = median(std::move(ratios));
}

/// End points of a scan in cells, at most `most`.
struct CellPoints {
  std::vector<float> x, y;
  explicit CellPoints(const Scan& scan, std::size_t most) {
    const Endpoints points = thin(endpoints_in_robot(scan), most);
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
struct Fan {
  std::vector<double> cosine, sine;
  std::vector<float> cosine_f, sine_f;
  Fan() {
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
  void cast(const Pose2& pose, const Fan& fan) {
    std::fill(x_.begin(), x_.end(), static_cast<float>(pose.x / 0.05));
    std::fill(y_.begin(), y_.end(), static_cast<float>(pose.y / 0.05));
    limit::cast(limit_field(distances_), x_.data(), y_.data(), fan.cosine_f.data(),
                fan.sine_f.data(), 352, 200.0F, ranges_.data());
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
  const localization::RayCaster caster(scenario.map, 10.0);
  const Fan fan;
  BareCaster bare_caster(scenario.map);
  std::vector<double> ranges(352);
  std::vector<std::int32_t> cells(352);
  const auto ours = [&] {
    for (const Pose2& pose : scenario.truth) {
      caster.expected_ranges_m(
          {pose.x, pose.y, 1.0, 0.0, fan.cosine.data(), fan.sine.data(), 352, 10.0}, ranges.data(),
          cells.data());
      benchmark::DoNotOptimize(ranges.data());
    }
  };
  const auto bare = [&] {
    for (const Pose2& pose : scenario.truth) bare_caster.cast(pose, fan);
  };
  compare(state, static_cast<double>(352 * scenario.truth.size()), ours, bare);
}
BENCHMARK(ray_query);

/// 500 particles about the true pose of each tenth scan.
std::vector<localization::ParticleSet> clouds() {
  RandomStream random(5, StreamId::kTest);
  std::vector<localization::ParticleSet> sets;
  for (std::size_t n = 0; n < peers_scenario().truth.size(); n += 10) {
    localization::ParticleSet set;
    set.resize(500);
    const Pose2& truth = peers_scenario().truth[n];
    for (std::size_t i = 0; i < set.size(); ++i) {
      set.set_pose(i, {truth.x + 0.1 * random.normal(), truth.y + 0.1 * random.normal(),
                       truth.theta + 0.03 * random.normal()});
    }
    localization::set_uniform_weights(set);
    sets.push_back(std::move(set));
  }
  return sets;
}

/// Weighs all clouds; returns how many beams and particles that were.
double weigh(const localization::SensorModel& model, std::vector<localization::ParticleSet>& sets) {
  std::vector<double> log(500);
  WorkerPool pool(1);
  double pairs = 0.0;
  for (std::size_t n = 0; n < sets.size(); ++n) {
    const Scan& scan = peers_scenario().observations[10 * n].scan;
    pairs += 500.0 * static_cast<double>(model.log_likelihoods(scan, 1.0, sets[n], log, pool));
    benchmark::DoNotOptimize(log.data());
  }
  return pairs;
}

/// The beam model, one beam every 5 degrees, per beam and particle; the limit is its ray query.
void beam_model(benchmark::State& state) {
  const auto& scenario = peers_scenario();
  if (!scenario.found) return state.SkipWithError("no peers_scenario in STRATA_DATA_DIR");
  const auto model = localization::make_grid_beam_model(scenario.map);
  auto sets = clouds();
  const double pairs = weigh(*model, sets);
  const Fan fan;
  BareCaster bare_caster(scenario.map);
  const auto fans = static_cast<std::size_t>(pairs / 352.0);
  const auto bare = [&] {
    for (std::size_t n = 0; n < fans; ++n) {
      bare_caster.cast(scenario.truth[n % scenario.truth.size()], fan);
    }
  };
  compare(
      state, pairs, [&] { weigh(*model, sets); }, bare);
}
BENCHMARK(beam_model);

/// The scenario's map with a sub-map of 4 m x 4 m and two configurations at every 30th pose.
std::shared_ptr<const patch::PatchMap> patched_map() {
  const auto& scenario = peers_scenario();
  auto map = std::make_shared<patch::PatchMap>();
  map->base = scenario.map;
  for (std::size_t n = 0; n < scenario.truth.size(); n += 30) {
    const Cell cell = scenario.map.cell_at(scenario.truth[n].translation());
    patch::Submap submap;
    submap.id = static_cast<int>(map->submaps.size());
    submap.rect =
        CellRect{cell, {cell.x + 1, cell.y + 1}}.inflated(40).intersected(scenario.map.rect());
    for (int k = 0; k < 2; ++k) {
      patch::Configuration configuration;
      configuration.reflection = scenario.map.cropped(submap.rect);
      configuration.prior = 0.5;
      const CellRect box =
          CellRect{{cell.x + 20, cell.y - 8}, {cell.x + 30, cell.y + 8}}.intersected(submap.rect);
      for (int y = box.min.y; y < box.max.y && k == 1; ++y) {
        for (int x = box.min.x; x < box.max.x; ++x) configuration.reflection.at({x, y}) = 1.0F;
      }
      submap.configurations.push_back(std::move(configuration));
    }
    map->submaps.push_back(std::move(submap));
  }
  return map;
}

/// The beam model in the patched map, against the same without: what the patch state costs.
/// Argument: PatchMemory.
void patch_state(benchmark::State& state) {
  const auto& scenario = peers_scenario();
  if (!scenario.found) return state.SkipWithError("no peers_scenario in STRATA_DATA_DIR");
  localization::PatchBeamModelConfig config;
  config.states.memory = static_cast<localization::PatchMemory>(state.range(0));
  const localization::PatchBeamModel model(patched_map(), config);
  const auto grid = localization::make_grid_beam_model(scenario.map);
  auto sets = clouds();
  auto patched = sets;
  RandomStream random(6, StreamId::kTest);
  for (localization::ParticleSet& set : patched) {
    model.patch_states()->prepare(set);
    for (std::size_t i = 0; i < set.size(); ++i) model.patch_states()->draw(set, i, random);
  }
  const double pairs = weigh(*grid, sets);
  compare(
      state, pairs, [&] { weigh(model, patched); }, [&] { weigh(*grid, sets); });
}
BENCHMARK(patch_state)->ArgName("memory")->DenseRange(0, 2);

/// Times of whole drives, made in turn with bare ones.
class Drives {
 public:
  void begin() {
    ours_.push_back(0.0);
    bare_.push_back(0.0);
  }
  template <typename Ours, typename Bare>
  void add(Ours&& ours, Bare&& bare) {
    ours_.back() += seconds_of(ours);
    bare_.back() += seconds_of(bare);
  }
  void report(benchmark::State& state, double items) const {
    std::vector<double> ratios;
    for (std::size_t n = 0; n < ours_.size(); ++n) ratios.push_back(ours_[n] / bare_[n]);
    state.counters["ours_ns"] = median(ours_) / items * 1e9;
    state.counters["limit_ns"] = median(bare_) / items * 1e9;
    state.counters["ratio"] = median(std::move(ratios));
  }

 private:
  std::vector<double> ours_, bare_;
};

/// The same for whole updates along the scenario. Arguments: PatchMemory, particles, beams.
void patch_update(benchmark::State& state) {
  const auto& scenario = peers_scenario();
  if (!scenario.found) return state.SkipWithError("no peers_scenario in STRATA_DATA_DIR");
  localization::PatchBeamModelConfig config;
  config.states.memory = static_cast<localization::PatchMemory>(state.range(0));
  const auto particles = static_cast<std::size_t>(state.range(1));
  config.beam.beams.least_angle_rad = 6.283 / static_cast<double>(state.range(2));
  const localization::LocalizerConfig fixed = bench::fixed_particles(static_cast<int>(particles));
  localization::Localizer patched(
      fixed, std::make_shared<localization::PatchBeamModel>(patched_map(), config), 1);
  localization::Localizer plain(fixed,
                                localization::make_grid_beam_model(scenario.map, config.beam), 1);
  Drives drives;
  for (auto _ : state) {
    for (localization::Localizer* localizer : {&patched, &plain}) {
      localizer->initialize({scenario.truth[0], Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal()});
    }
    drives.begin();
    // In turn, scan by scan: what else the machine does hits both.
    for (const Observation& observation : scenario.observations) {
      drives.add([&] { benchmark::DoNotOptimize(patched.update(observation)); },
                 [&] { benchmark::DoNotOptimize(plain.update(observation)); });
    }
  }
  const auto beams = static_cast<double>(
      localization::select_beams(scenario.observations[0].scan, config.beam.beams).size());
  drives.report(state, static_cast<double>(particles) * beams *
                           static_cast<double>(scenario.observations.size()));
}
BENCHMARK(patch_update)
    ->ArgNames({"memory", "particles", "beams"})
    ->ArgsProduct({{0, 1, 2}, {500, 2000, 10000}, {60, 72, 180, 360}})
    ->ArgsProduct({{0, 1, 2}, {100000}, {72}});

}  // namespace
}  // namespace strata
