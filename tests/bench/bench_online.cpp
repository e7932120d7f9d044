// SPDX-License-Identifier: Apache-2.0
/// From a scan on /scan to its labels on /scan_static, over DDS, at 40 Hz and 1,080 beams: what a
/// robot waits for. docs/benchmarks.md has the figures.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>

#include "components/beam_filter/register.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/scan_matcher/register.hpp"
#include "core/beam_filter/online_filter.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/core/slam/ring_world.hpp"

namespace strata {
namespace {

using Clock = std::chrono::steady_clock;
using sensor_msgs::msg::LaserScan;

constexpr int kBeams = 1'080;
constexpr auto kPeriod = std::chrono::milliseconds(25);

/// Once and a half round a block, so that a loop closes on the way.
std::vector<Observation> ring_log() {
  const std::vector<Pose2> path = test::drive_round(0.0175, 60.0);  // 0.7 m/s
  std::vector<Observation> log;
  for (std::size_t i = 0; i < path.size(); ++i) {
    Observation observation;
    observation.scan = test::scan_of(test::ring(), path[i], 1.0 + 0.025 * static_cast<double>(i),
                                     0.01, 1, kBeams, 1.5 * std::numbers::pi);
    observation.odom_from_robot = path[i];
    log.push_back(std::move(observation));
  }
  return log;
}

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

struct Robot {
  std::shared_ptr<bus::Participant> participant = test::make_participant();
  Answers answers{participant};
  bus::Writer<LaserScan> scans{participant, "/scan", bus::qos_profile("sensor_data")};
  bus::Writer<nav_msgs::msg::Odometry> odometry{participant, "/odom",
                                                bus::qos_profile("sensor_data")};
  bus::Writer<tf2_msgs::msg::TFMessage> mounting{participant, "/tf_static",
                                                 bus::qos_profile("latched")};
  void see(const Observation& observation) {
    nav_msgs::msg::Odometry message;
    message.header().stamp(convert::to_message(observation.scan.stamp));
    message.header().frame_id("odom");
    message.child_frame_id("base_link");
    message.pose().pose().position().x(observation.odom_from_robot.x);
    message.pose().pose().position().y(observation.odom_from_robot.y);
    message.pose().pose().orientation().z(std::sin(0.5 * observation.odom_from_robot.theta));
    message.pose().pose().orientation().w(std::cos(0.5 * observation.odom_from_robot.theta));
    odometry.publish(message);
    scans.publish(convert::to_message(observation.scan, "laser"));
  }
};

void tell(benchmark::State& state, std::vector<double> each_ms) {
  std::sort(each_ms.begin(), each_ms.end());
  const auto at = [&](double share) {
    return each_ms[static_cast<std::size_t>(share * static_cast<double>(each_ms.size() - 1))];
  };
  state.counters["median_ms"] = at(0.5);
  state.counters["p99_ms"] = at(0.99);
  state.counters["max_ms"] = at(1.0);
  state.counters["scans"] = static_cast<double>(each_ms.size());
}

/// One iteration: the whole drive at its own pace. Counters: milliseconds from publishing a scan to
/// its labels, and how many came later than one period or never.
void label_latency(benchmark::State& state) {
  const std::vector<Observation> log = ring_log();
  runtime::Registry registry;
  scan_matcher::register_component(registry);
  beam_filter::register_component(registry);
  Robot robot;
  const auto host = test::make_host(
      "{type: strata::ScanMatcher, name: matcher}, {type: strata::BeamFilter, name: filter}",
      registry, test::make_participant());
  host->activate();
  tf2_msgs::msg::TFMessage tf;
  tf.transforms().push_back(convert::to_transform_stamped(Stamp{}, Pose2{}, "base_link", "laser"));
  robot.mounting.publish(tf);
  if (!robot.scans.raw().wait_for_readers(1, std::chrono::seconds(20)) ||
      !robot.odometry.raw().wait_for_readers(1, std::chrono::seconds(20))) {
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
      sent.push_back(Clock::now());
      robot.see(log[i]);
    }
    std::this_thread::sleep_for(std::chrono::seconds(1));
    const auto came = robot.answers.take();
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
/// loops where they fall due. Holds on a busy machine too.
void label_work(benchmark::State& state) {
  const std::vector<Observation> log = ring_log();
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
BENCHMARK(label_work)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace strata
