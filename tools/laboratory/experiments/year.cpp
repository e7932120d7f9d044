// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/year.hpp"

#include <chrono>
#include <ctime>
#include <fstream>
#include <memory>
#include <optional>
#include <vector>

#include <unistd.h>

#include "components/maps/map_model.hpp"
#include "core/base/parallel.hpp"
#include "core/localization/localizer.hpp"
#include "core/patch/online_learner.hpp"
#include "memory/store/store.hpp"
#include "tools/laboratory/experiments/simulated_maps.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::experiments {
namespace {

using localization::Localizer;
using localization::LocalizerConfig;

constexpr double kFailure_m = 0.5;
/// How often the localizer takes over what the memory has learned, and the memory is saved.
constexpr double kRenew_s = 10.0;
/// What was learned more recently than this does not count yet: the robot would follow itself.
constexpr double kUnsettled_s = 20.0;
constexpr std::size_t kResidentNodes = 500;
/// Of the patch learner. It is asked for its map only once a day; and what it learns anew from the
/// scans that it keeps takes time with their number.
constexpr double kPatchCheck_s = 20.0;
constexpr double kPatchBudget_mb = 48.0;
/// Of the poses that a learner takes a scan from.
constexpr double kMaxStddev_m = 0.1;

double cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double resident_mb() {
  std::ifstream in("/proc/self/statm");
  double all = 0.0;
  double resident = 0.0;
  in >> all >> resident;
  return 1e-6 * resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

PosedScan posed(const simulate::SimulatedScan& scan, const Pose2& map_from_robot) {
  return {scan.observation.run, scan.observation.scan, map_from_robot, {}};
}

/// A robot that is on its own.
class Track {
 public:
  Track(std::string name, const ReflectionGrid& day_1, const Pose2& start,
        const YearOptions& options)
      : name_(std::move(name)) {
    config_.particles = options.particles;
    config_.adaptive = false;
    seed_ = options.seed;
    free_space_ = day_1;
    start_ = start;
  }
  virtual ~Track() = default;
  Track(const Track&) = delete;
  Track& operator=(const Track&) = delete;

  [[nodiscard]] YearTrack live(const simulate::SimulatedDay& day) {
    const double begin_s = cpu_s();
    begin_day();
    YearTrack result;
    result.name = name_;
    for (const simulate::SimulatedScan& scan : day.scans) {
      const localization::LocalizationResult& found = localizer_->update(scan.observation);
      const double error_m = weighted_error(localizer_->particles(), scan.map_from_robot);
      result.error_m += error_m / static_cast<double>(day.scans.size());
      result.worst_m = std::max(result.worst_m, error_m);
      result.failures += error_m > kFailure_m ? 1 : 0;
      ++result.scans;
      after_scan(scan, found.pose);
    }
    result.cpu_s = cpu_s() - begin_s;
    return result;
  }

 protected:
  virtual void begin_day() {}
  virtual void after_scan(const simulate::SimulatedScan& /*scan*/, const Pose2Gaussian& /*pose*/) {}

  /// The first map starts the filter, later ones only take its place.
  void use(const maps::Maps& maps, const std::string& model) {
    const maps::MapModel made = maps::make_map_model(maps, model, {});
    if (localizer_) {
      localizer_->set_model(made.sensor);
      return;
    }
    localizer_.emplace(config_, made.sensor, seed_, 1);
    localizer_->set_free_space(free_space_);
    localizer_->initialize({start_, Eigen::Vector3d(0.01, 0.01, 0.0025).asDiagonal()});
  }

 private:
  std::string name_;
  LocalizerConfig config_;
  std::uint64_t seed_ = 1;
  ReflectionGrid free_space_;
  Pose2 start_;
  std::optional<Localizer> localizer_;
};

class FrozenTrack final : public Track {
 public:
  FrozenTrack(const ReflectionGrid& day_1, const Pose2& start, const YearOptions& options)
      : Track("frozen", day_1, start, options) {
    maps::Maps maps;
    maps.filtered = day_1;
    use(maps, "filtered");
  }
};

class MemoryTrack final : public Track {
 public:
  MemoryTrack(const std::vector<PosedScan>& day, const ReflectionGrid& day_1, const Pose2& start,
              const YearOptions& options)
      : Track("memory", day_1, start, options),
        store_(options.out / "strata.db", {.check = false}),
        memory_(with_slow_levels(), options.seed),
        model_(options.memory_model),
        decoding_(options.decoding) {
    for (const PosedScan& scan : day) memory_.observe(scan);
    renew(0.0);
  }
  [[nodiscard]] std::size_t nodes() const { return memory_.nodes().size(); }
  [[nodiscard]] double store_mb() const {
    double bytes = 0.0;
    for (const char* end : {"", "-wal", "-shm"}) {
      std::error_code missing;
      const auto size = std::filesystem::file_size(store_.path().string() + end, missing);
      bytes += missing ? 0.0 : static_cast<double>(size);
    }
    return 1e-6 * bytes;
  }

 private:
  static memory::TimescaleConfig with_slow_levels() {
    memory::TimescaleConfig config;
    config.levels.push_back({"weekly", 50, 693.0, 5.0});
    return config;
  }
  void renew(double unsettled_s) {
    store_.save_timescale_changes(memory_, saved_);
    memory_.evict(kResidentNodes, store_.timescale_nodes());
    maps::Maps maps;
    nodes_ = memory_.decode(decoding_, nodes_.get(), unsettled_s);
    maps.nodes = nodes_;
    use(maps, model_);
  }
  void begin_day() override { last_renewed_.reset(); }
  void after_scan(const simulate::SimulatedScan& scan, const Pose2Gaussian& pose) override {
    memory_.observe(posed(scan, pose.mean), &pose.covariance);
    const Stamp now = scan.observation.scan.stamp;
    if (!last_renewed_) last_renewed_ = now;
    if ((now - *last_renewed_).seconds() < kRenew_s) return;
    last_renewed_ = now;
    renew(kUnsettled_s);
  }

  memory::Store store_;
  memory::SavedTimescale saved_;
  memory::TimescaleMemory memory_;
  std::string model_;
  memory::DecodingConfig decoding_;
  std::shared_ptr<const memory::NodeMap> nodes_;
  std::optional<Stamp> last_renewed_;
};

class PatchTrack final : public Track {
 public:
  PatchTrack(const std::vector<PosedScan>& day, const ReflectionGrid& day_1, const Pose2& start,
             const YearOptions& options)
      : Track("patches", day_1, start, options),
        learner_({}, {kPatchCheck_s, kPatchBudget_mb}, day_1, 1),
        day_1_(day_1) {
    for (const PosedScan& scan : day) learner_.add(scan);
    renew();
  }
  [[nodiscard]] std::size_t submaps() const { return submaps_; }
  [[nodiscard]] double megabytes() const {
    return 1e-6 * static_cast<double>(learner_.status().bytes);
  }

 private:
  void renew() {
    maps::Maps maps;
    maps.filtered = day_1_;
    maps.patches = learner_.map();
    submaps_ = maps.patches->submaps.size();
    use(maps, "patch");
  }
  void begin_day() override {
    if (has_changed_) renew();
    has_changed_ = false;
  }
  void after_scan(const simulate::SimulatedScan& scan, const Pose2Gaussian& pose) override {
    const double stddev_m = std::sqrt(std::max(pose.covariance(0, 0), pose.covariance(1, 1)));
    // A sequence of scans needs no twelve a second: one every 0.4 m of way.
    if (stddev_m > kMaxStddev_m || ++count_ % 6 != 0) return;
    has_changed_ = learner_.add(posed(scan, pose.mean)) || has_changed_;
  }

  patch::OnlinePatchLearner learner_;
  ReflectionGrid day_1_;
  std::size_t submaps_ = 0;
  std::size_t count_ = 0;
  bool has_changed_ = false;
};

double path_m(const simulate::SimulatedDay& day) {
  double sum = 0.0;
  for (std::size_t i = 1; i < day.scans.size(); ++i) {
    sum += translation_distance(day.scans[i - 1].map_from_robot, day.scans[i].map_from_robot);
  }
  return sum;
}

}  // namespace

void run_year(const YearOptions& options, const std::function<void(const YearDay&)>& each_day) {
  simulate::ScenarioConfig scenario = simulate::load_scenario(options.scenario, options.overrides);
  scenario.days = options.days;
  simulate::Simulator simulator(scenario, options.seed);
  std::filesystem::create_directories(options.out);
  simulate::SimulatedDay day = simulator.next_day();
  simulate::Simulation first = simulator.world();
  first.days.push_back(day);
  const std::vector<PosedScan> mapped = noisy_scans(first, kGoodPoses, options.seed, 1, 1);
  const Pose2 start = day.scans.back().map_from_robot;
  const ReflectionGrid map = static_maps(mapped).filtered;
  FrozenTrack frozen(map, start, options);
  MemoryTrack memory(mapped, map, start, options);
  std::optional<PatchTrack> patches;
  if (options.with_patches) patches.emplace(mapped, map, start, options);
  std::vector<Track*> tracks{&memory, &frozen};
  if (patches) tracks.insert(tracks.begin() + 1, &*patches);
  first.days.clear();
  if (options.days > 1) day = simulator.next_day();
  WorkerPool pool(2);
  for (int number = 2; number <= options.days; ++number) {
    const auto begin = std::chrono::steady_clock::now();
    YearDay figures;
    figures.day = number;
    figures.path_m = path_m(day);
    figures.tracks.resize(tracks.size());
    simulate::SimulatedDay tomorrow;
    // The longest first.
    pool.for_chunks(tracks.size() + 1, 1, [&](std::size_t task, std::size_t, std::size_t) {
      if (task < tracks.size()) {
        figures.tracks[task] = tracks[task]->live(day);
      } else if (number < options.days) {
        tomorrow = simulator.next_day();
      }
    });
    day = std::move(tomorrow);
    figures.nodes = memory.nodes();
    figures.store_mb = memory.store_mb();
    figures.rss_mb = resident_mb();
    figures.submaps = patches ? patches->submaps() : 0;
    figures.patch_mb = patches ? patches->megabytes() : 0.0;
    figures.wall_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    each_day(figures);
  }
}

}  // namespace strata::experiments
