// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/score_samples.hpp"

#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

#include "tools/laboratory/experiments/spliced_drive.hpp"

namespace strata::experiments {
namespace {

constexpr std::size_t kSearching = 250;
constexpr std::size_t kBefore = 100;
constexpr std::size_t kAfter = 200;
constexpr std::size_t kStartedOff = 120;

/// The drives of one world and model, numbered as they begin.
class Drives {
 public:
  Drives(const VerdictWorld& world, const std::string& model)
      : world_(&world), sensor_(sensor_of(world, model)), size_(world.observations.size()) {}

  void track(std::size_t from) {
    SplicedDrive drive = begin();
    drive.start(*world_->truths[from]);
    record(drive, from, size_, {.is_tracked = true});
  }
  void search(std::size_t from) {
    SplicedDrive drive = begin();
    drive.localizer().initialize_global(world_->maps.filtered);
    record(drive, from, from + kSearching, {.is_anywhere = true});
  }
  void start_off(std::size_t from, int time) {
    SplicedDrive drive = begin();
    Pose2 off = *world_->truths[from];
    const double distance_m = 1.0 + 0.7 * (time % 4);
    off.x += distance_m * std::cos(1.1 * time);
    off.y += distance_m * std::sin(1.1 * time);
    drive.start(off);
    record(drive, from, from + kStartedOff, {});
  }
  void carry_away(std::size_t from, int time) {
    SplicedDrive drive = begin();
    drive.start(*world_->truths[from]);
    record(drive, from, from + kBefore, {});
    const std::size_t to = from + 5 * size_ / 12 + 37 * static_cast<std::size_t>(time);
    const std::size_t last = size_ > kAfter ? size_ - kAfter : size_;
    record(drive, to % last, to % last + kAfter, {});
  }
  [[nodiscard]] std::vector<ScoreSample> take() { return std::move(samples_); }

 private:
  SplicedDrive begin() { return {*world_, sensor_, ++drives_}; }
  void record(SplicedDrive& drive, std::size_t from, std::size_t to, ScoreSample sample) {
    const localization::Localizer& localizer = drive.localizer();
    drive.drive(from, to, [&](const auto& result, double error_m, Stamp) {
      sample.drive = drives_;
      sample.evidence = localizer.score_evidence();
      sample.score = result.place_score;
      sample.error_m = error_m;
      sample.is_lost = result.health.state == localization::HealthState::kLost;
      samples_.push_back(sample);
      return true;
    });
  }

  const VerdictWorld* world_;
  std::shared_ptr<const localization::SensorModel> sensor_;
  std::size_t size_;
  std::uint64_t drives_ = 0;  // and the seed of the last one
  std::vector<ScoreSample> samples_;
};

}  // namespace

std::vector<ScoreSample> score_samples(const VerdictWorld& world, const std::string& model,
                                       int times) {
  Drives drives(world, model);
  const std::size_t n = world.observations.size();
  const std::size_t first = known_from(world, 0);
  if (first < n) drives.track(first);
  for (int time = 0; time < times; ++time) {
    const std::size_t from =
        known_from(world, static_cast<std::size_t>(time) * n / static_cast<std::size_t>(times));
    if (from >= n) continue;
    drives.search(from);
    drives.carry_away(from, time);
    drives.start_off(from, time);
  }
  return drives.take();
}

}  // namespace strata::experiments
