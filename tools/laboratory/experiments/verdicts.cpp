// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/verdicts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "components/maps/map_model.hpp"
#include "core/base/error.hpp"
#include "core/localization/localizer.hpp"
#include "tools/laboratory/experiments/simulated_maps.hpp"
#include "tools/laboratory/experiments/wean.hpp"
#include "tools/pipeline/compare_config.hpp"
#include "tools/pipeline/learn.hpp"
#include "tools/simulate/random_office.hpp"

namespace strata::experiments {
namespace {

constexpr double kRight_m = 0.5;
constexpr double kWrong_m = 1.0;
constexpr int kSoon = 20;
constexpr int kAWhile = 10;
constexpr std::size_t kTracked = 150;
constexpr std::size_t kKidnapped = 150;
constexpr double kLearnedShare = 0.6;
constexpr double kJump_m = 1.5;
constexpr double kScan_s = 0.1;
constexpr std::uint64_t kOffices = 10;

using localization::Localizer;

std::shared_ptr<const localization::SensorModel> sensor_of(const VerdictWorld& world,
                                                           const std::string& model) {
  if (model == "field") {
    return maps::make_likelihood_field_model(world.maps, "filtered", {}).sensor;
  }
  return maps::make_map_model(world.maps, model, pipeline::CompareConfig{}.sensor).sensor;
}

/// A localizer that sees parts of a drive as if each followed on the one before.
class Splicer {
 public:
  Splicer(const VerdictWorld& world, std::shared_ptr<const localization::SensorModel> sensor,
          std::uint64_t seed)
      : world_(&world), localizer_(pipeline::CompareConfig{}.localizer, std::move(sensor), seed) {}

  [[nodiscard]] Localizer& localizer() { return localizer_; }

  /// Calls said(result, error in m) for each weighed scan of [begin, end) whose truth is known,
  /// until that returns false. Ends early where the log itself has a gap.
  template <typename Said>
  void drive(std::size_t begin, std::size_t end, Said&& said) {
    for (std::size_t i = begin; i < std::min(end, world_->observations.size()); ++i) {
      if (i > begin && !move(world_->observations[i - 1], world_->observations[i])) return;
      if (i == begin) stamp_ = Stamp::from_seconds(stamp_.seconds() + kScan_s);
      Observation observation = world_->observations[i];
      observation.run = 0;
      observation.odom_from_robot = odom_;
      observation.scan.stamp = stamp_;
      const localization::LocalizationResult& result = localizer_.update(observation);
      if (!result.weighed || !world_->truths[i]) continue;
      const Pose2& truth = *world_->truths[i];
      if (!said(result, (result.pose.mean.translation() - truth.translation()).norm())) return;
    }
  }

 private:
  bool move(const Observation& before, const Observation& now) {
    const Pose2 motion = between(before.odom_from_robot, now.odom_from_robot);
    odom_ = odom_ * motion;
    stamp_ = Stamp::from_seconds(stamp_.seconds() + (now.scan.stamp - before.scan.stamp).seconds());
    return std::hypot(motion.x, motion.y) < kJump_m;
  }

  const VerdictWorld* world_;
  Localizer localizer_;
  Pose2 odom_;
  Stamp stamp_ = Stamp::from_seconds(1.0);
};

/// The first place from `at` on whose truth is known; the number of observations if there is none.
std::size_t known_from(const VerdictWorld& world, std::size_t at) {
  while (at < world.truths.size() && !world.truths[at]) ++at;
  return at;
}

void start(Splicer& splicer, const Pose2& truth) {
  const pipeline::CompareProtocol protocol;
  const double m = protocol.start_stddev_m;
  const double rad = protocol.start_stddev_rad;
  splicer.localizer().initialize({truth, Eigen::Vector3d(m * m, m * m, rad * rad).asDiagonal()});
}

void count_tracked(const VerdictWorld& world, Splicer splicer, VerdictCounts& counts) {
  const std::size_t begin = known_from(world, 0);
  if (begin == world.truths.size()) {
    throw InputError(world.name, "has no scan whose truth is known", "give poses of that time");
  }
  start(splicer, *world.truths[begin]);
  splicer.drive(begin, world.observations.size(), [&](const auto& result, double error_m) {
    if (error_m >= kRight_m) return true;
    ++counts.scans;
    counts.doubtful += result.health.is_in_doubt ? 1 : 0;
    counts.lost += result.health.state == localization::HealthState::kLost ? 1 : 0;
    return true;
  });
}

void count_kidnapped(const VerdictWorld& world, Splicer splicer, std::size_t from, std::size_t to,
                     VerdictCounts& counts) {
  start(splicer, *world.truths[from]);
  splicer.drive(from, from + kTracked, [](const auto&, double) { return true; });
  int scans = 0;
  std::optional<int> doubtful;
  std::optional<int> lost;
  splicer.drive(to, to + kKidnapped, [&](const auto& result, double error_m) {
    if (error_m < kWrong_m) return false;
    if (!doubtful && result.health.is_in_doubt) doubtful = scans;
    if (!lost && result.health.state == localization::HealthState::kLost) lost = scans;
    ++scans;
    return true;
  });
  if (scans < kAWhile) return;
  ++counts.kidnapped;
  counts.doubtful_soon += doubtful && *doubtful < kSoon ? 1 : 0;
  counts.lost_soon += lost && *lost < kSoon ? 1 : 0;
  counts.doubtful_ever += doubtful ? 1 : 0;
  counts.lost_ever += lost ? 1 : 0;
}

void print(const std::string& name, const VerdictCounts& c) {
  std::printf(
      "%s: right pose: doubtful %zu, lost %zu of %zu scans; kidnapped: doubtful within %d scans "
      "%zu, ever %zu, lost within %d scans %zu, ever %zu, of %zu\n",
      name.c_str(), c.doubtful, c.lost, c.scans, kSoon, c.doubtful_soon, c.doubtful_ever, kSoon,
      c.lost_soon, c.lost_ever, c.kidnapped);
  std::fflush(stdout);
}

constexpr const char* kModels[] = {"patch", "filtered", "field"};

void report(const VerdictWorld& world, int times, std::uint64_t seed) {
  for (const char* model : kModels) {
    print(world.name + ", " + model, count_verdicts(world, model, times, seed));
  }
}

void report_runs(const std::filesystem::path& folder, std::uint64_t seed) {
  const WeanRuns wean = read_wean_runs(folder, 2);
  for (int held_out = 0; held_out < 3; ++held_out) {
    WeanMaps learned =
        learn_wean_maps(wean, {held_out == 0 ? 1 : 0, held_out == 2 ? 1 : 2}, true, 2);
    VerdictWorld world;
    world.name = "run " + std::to_string(held_out + 1) + " held out";
    world.maps = std::move(learned.maps);
    for (std::size_t i = 0; i < wean.runs.observations.size(); ++i) {
      if (wean.runs.observations[i].run != held_out) continue;
      world.observations.push_back(wean.runs.observations[i]);
      world.truths.emplace_back();
      if (wean.common[i]) world.truths.back() = learned.map_from_common * *wean.common[i];
    }
    report(world, 12, seed);
  }
}

}  // namespace

VerdictCounts& VerdictCounts::operator+=(const VerdictCounts& other) {
  for (std::size_t VerdictCounts::*count :
       {&VerdictCounts::scans, &VerdictCounts::doubtful, &VerdictCounts::lost,
        &VerdictCounts::kidnapped, &VerdictCounts::doubtful_soon, &VerdictCounts::lost_soon,
        &VerdictCounts::doubtful_ever, &VerdictCounts::lost_ever}) {
    this->*count += other.*count;
  }
  return *this;
}

VerdictCounts count_verdicts(const VerdictWorld& world, const std::string& model, int times,
                             std::uint64_t seed) {
  const auto sensor = sensor_of(world, model);
  VerdictCounts counts;
  count_tracked(world, Splicer(world, sensor, seed), counts);
  const std::size_t n = world.observations.size();
  const auto parts = static_cast<std::size_t>(times);
  if (n <= kKidnapped) return counts;
  for (std::size_t k = 0; k < parts; ++k) {
    const std::size_t from = known_from(world, k * n / parts);
    // Elsewhere, and not always as far along the drive.
    const std::size_t to = (from + 5 * n / 12 + 37 * k) % (n - kKidnapped);
    if (from + kTracked >= n) continue;
    count_kidnapped(world, Splicer(world, sensor, seed + k + 1), from, to, counts);
  }
  return counts;
}

VerdictWorld world_of_log(const std::string& log, const std::string& poses) {
  pipeline::RunsInput input;
  input.logs = {log};
  input.poses = {poses};
  const pipeline::Runs runs = pipeline::read_runs(input, nullptr);
  const auto learned =
      static_cast<std::ptrdiff_t>(kLearnedShare * static_cast<double>(runs.observations.size()));
  const pipeline::LearnParts parts{.patch = true, .timescale = false};
  const pipeline::LearnResult result =
      pipeline::learn({runs.observations.begin(), runs.observations.begin() + learned},
                      {runs.poses.begin(), runs.poses.begin() + learned},
                      pipeline::learn_at_given_poses(), parts, 1, 2, nullptr);
  return {std::filesystem::path(log).filename().string(),
          pipeline::maps_of(result, {}),
          {runs.observations.begin() + learned, runs.observations.end()},
          {runs.poses.begin() + learned, runs.poses.end()}};
}

VerdictWorld world_of_office(std::uint64_t office) {
  constexpr std::uint64_t kSeeds = 100;
  const simulate::Simulation simulation =
      simulate::simulate(simulate::random_office(office, {4, true, 2}), kSeeds + office);
  const std::vector<PosedScan> scans = noisy_scans(simulation, kGoodPoses, kSeeds + office, 1, 3);
  const StaticMaps maps = static_maps(scans);
  VerdictWorld world;
  world.name = "office " + std::to_string(office);
  world.maps.occupancy = maps.occupancy;
  world.maps.filtered = maps.filtered;
  world.maps.patches = learn_patches(scans, maps.filtered);
  for (const simulate::SimulatedScan& scan : simulation.days.back().scans) {
    world.observations.push_back(scan.observation);
    world.truths.emplace_back(scan.map_from_robot);
  }
  return world;
}

void report_verdicts(const std::filesystem::path& runs, const std::vector<std::string>& logs,
                     const std::vector<std::string>& poses, std::uint64_t seed) {
  for (std::size_t i = 0; i < logs.size(); ++i) report(world_of_log(logs[i], poses[i]), 10, seed);
  if (!runs.empty()) report_runs(runs, seed);
  std::vector<VerdictWorld> offices;
  for (std::uint64_t n = 0; n < kOffices; ++n) offices.push_back(world_of_office(seed + n));
  for (const char* model : kModels) {
    VerdictCounts sum;
    for (const VerdictWorld& office : offices) sum += count_verdicts(office, model, 8, seed);
    print(std::string("ten random offices, ") + model, sum);
  }
}

}  // namespace strata::experiments
