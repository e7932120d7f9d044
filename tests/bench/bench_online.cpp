// SPDX-License-Identifier: Apache-2.0
/// From a scan on /scan to its labels on /scan_static, over DDS, at 40 Hz and 1,080 beams: what a
/// robot waits for. docs/benchmarks.md has the figures.
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>

#include "components/beam_filter/register.hpp"
#include "components/scan_matcher/register.hpp"
#include "core/beam_filter/online_filter.hpp"
#include "tests/bench/ring_drive.hpp"
#include "tests/components/runtime/host_fixture.hpp"

namespace strata {
namespace {

using Clock = std::chrono::steady_clock;
using bench::kPeriod;
using bench::ring_log;
using bench::Robot;
using bench::tell;
using sensor_msgs::msg::LaserScan;

/// When the answer to each stamp came.
class Answers {
 public:
  explicit Answers(std::shared_ptr<bus::Participant> participant)
      : reader_(std::move(participant), "/scan_static", bus::qos_profile("sensor_data"),
                [this](const LaserScan& scan) {
                  const std::lock_guard lock(mutex_);
                  at_[convert::from_message(scan.header().stamp()).ns] = Clock::now();
                }) {}
  [[nodiscard]] std::map<std::int64_t, Clock::time_point> take() {
    const std::lock_guard lock(mutex_);
    return at_;
  }

 private:
  std::mutex mutex_;
  std::map<std::int64_t, Clock::time_point> at_;
  bus::Reader<LaserScan> reader_;
};

/// One iteration: the whole drive at its own pace. Counters: milliseconds from publishing a scan to
/// its labels, and how many came later than one period or never.
void label_latency(benchmark::State& state) {
  const std::vector<Observation> log = ring_log();
  runtime::Registry registry;
  scan_matcher::register_component(registry);
  beam_filter::register_component(registry);
  Robot robot;
  Answers answers(robot.participant);
  const auto host = test::make_host(
      "{type: strata::ScanMatcher, name: matcher}, {type: strata::BeamFilter, name: filter}",
      registry, test::make_participant());
  host->activate();
  robot.tell_mounting();
  if (!robot.is_heard()) {
    return state.SkipWithError("the components were not found");
  }
  std::this_thread::sleep_for(std::chrono::seconds(1));
  std::vector<double> latency_ms;
  double late = 0.0;
  for (auto _ : state) {
    std::vector<Clock::time_point> sent;
    const Clock::time_point start = Clock::now();
    for (std::size_t i = 0; i < log.size(); ++i) {
      std::this_thread::sleep_until(start + static_cast<int>(i) * kPeriod);
      sent.push_back(robot.see(log[i]));
    }
    std::this_thread::sleep_for(std::chrono::seconds(1));
    const auto came = answers.take();
    for (std::size_t i = 0; i < log.size(); ++i) {
      const auto answer = came.find(log[i].scan.stamp.ns);
      const bool answered = answer != came.end();
      if (answered) {
        latency_ms.push_back(
            std::chrono::duration<double, std::milli>(answer->second - sent[i]).count());
      }
      if (!answered || latency_ms.back() > 25.0) late += 1.0;
    }
  }
  if (latency_ms.empty()) return state.SkipWithError("no labels came");
  tell(state, latency_ms);
  state.counters["late"] = late;
}
BENCHMARK(label_latency)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

double thread_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// What of that is work: CPU time of the pose and the labels of each scan, with the closures of
/// loops where they fall due. Holds on a busy machine too. Argument: beams.
void label_work(benchmark::State& state) {
  const std::vector<Observation> log = ring_log(static_cast<int>(state.range(0)));
  std::vector<double> work_ms;
  for (auto _ : state) {
    slam::Slam slam(slam::SlamConfig{});
    beam_filter::OnlineFilter filter;
    for (const Observation& observation : log) {
      const double before_ms = thread_ms();
      const Pose2Gaussian pose = slam.add(observation);
      benchmark::DoNotOptimize(filter.add({observation.run, observation.scan, pose.mean, {}}));
      work_ms.push_back(thread_ms() - before_ms);
    }
  }
  tell(state, work_ms);
}
BENCHMARK(label_work)->Arg(bench::kBeams)->Arg(4'000)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace strata
