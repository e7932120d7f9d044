// SPDX-License-Identifier: Apache-2.0
/// A day of mapping over DDS, as fast as it goes: a robot drives round a block for 25 hours of its
/// own time, and the process that maps tells what it holds in memory. docs/benchmarks.md has the
/// figures. STRATA_BENCH_HOURS: other than 25.
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>

#include "components/beam_filter/register.hpp"
#include "components/scan_matcher/register.hpp"
#include "tests/bench/ring_drive.hpp"
#include "tests/components/runtime/host_fixture.hpp"

namespace strata {
namespace {

constexpr double kScanPeriod_s = 0.2;
constexpr double kRound_m = 40.0;
constexpr double kStep_m = 0.14;  // 0.7 m/s
constexpr std::size_t kRecordedRounds = 4;
constexpr std::size_t kAhead = 5;  // scans on their way, at most

double resident_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word != "VmRSS:") continue;
    double kilobytes = 0.0;
    status >> kilobytes;
    return kilobytes / 1024.0;
  }
  return 0.0;
}

/// Scans of a few rounds, each with noise of its own, with steps of odometry that drift.
class Day {
 public:
  /// Half a step more than whole rounds: the last pose is the first one again.
  Day()
      : log_(test::record(test::ring(),
                          test::drive_round(kStep_m, kRecordedRounds * kRound_m + 0.5 * kStep_m), 0,
                          1)) {}
  /// The next of endlessly many.
  const Observation& next() {
    Observation& now = log_[at_];
    const Pose2 recorded = now.odom_from_robot;
    // The last recorded pose is the first one's again: from there the robot has not moved.
    if (at_ > 0) odometry_ = odometry_ * between(before_, recorded);
    before_ = recorded;
    out_ = now;
    out_.odom_from_robot = odometry_;
    out_.scan.stamp = Stamp::from_seconds(1.0 + kScanPeriod_s * static_cast<double>(count_++));
    at_ = (at_ + 1) % log_.size();
    return out_;
  }
  [[nodiscard]] double hours() const {
    return kScanPeriod_s * static_cast<double>(count_) / 3600.0;
  }

 private:
  std::vector<Observation> log_;
  Observation out_;
  std::size_t at_ = 0;
  std::size_t count_ = 0;
  Pose2 odometry_;
  Pose2 before_;
};

void mapping(benchmark::State& state) {
  const char* const wanted = std::getenv("STRATA_BENCH_HOURS");
  const double hours = wanted != nullptr ? std::atof(wanted) : 25.0;
  runtime::Registry registry;
  scan_matcher::register_component(registry);
  beam_filter::register_component(registry);
  bench::Robot robot;
  std::atomic<std::size_t> answers = 0;
  bus::Reader<strata_msgs::msg::LabeledScan> reader(
      robot.participant, "/labeled_scan", bus::qos_profile("default"),
      [&](const strata_msgs::msg::LabeledScan&) { ++answers; });
  const auto host = test::make_host(
      "{type: strata::ScanMatcher, name: matcher}, {type: strata::BeamFilter, name: filter}",
      registry, test::make_participant());
  host->activate();
  robot.tell_mounting();
  if (!robot.is_heard()) return state.SkipWithError("the components were not found");
  std::this_thread::sleep_for(std::chrono::seconds(1));
  Day day;
  std::size_t sent = 0;
  double least_mb = 1e9;
  double most_mb = 0.0;
  for (auto _ : state) {
    for (int hour = 1; hour <= static_cast<int>(hours); ++hour) {
      while (day.hours() < hour) {
        robot.see(day.next());
        ++sent;
        const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(1);
        while (answers + kAhead < sent && std::chrono::steady_clock::now() < until) {
          std::this_thread::sleep_for(std::chrono::microseconds(100));
        }
        if (answers + kAhead < sent) sent = answers;  // some were lost
      }
      const double now_mb = resident_mb();
      state.counters["hour_" + std::to_string(hour) + "_mb"] = now_mb;
      if (hour > 1) least_mb = std::min(least_mb, now_mb);
      if (hour > 1) most_mb = std::max(most_mb, now_mb);
    }
  }
  state.counters["least_mb_after_hour_1"] = least_mb;
  state.counters["most_mb_after_hour_1"] = most_mb;
  state.counters["scans"] = static_cast<double>(answers.load());
}
BENCHMARK(mapping)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

}  // namespace
}  // namespace strata
