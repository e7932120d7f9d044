// SPDX-License-Identifier: Apache-2.0
/// What DDS adds: from a scan on /scan to the robot's pose on /amcl_pose, composed in one process
/// and with a process of its own, beside Fast DDS alone; and what the timescale memory takes of a
/// core. docs/benchmarks.md has the figures.
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>
#include <signal.h>

#include "components/localizer/register.hpp"
#include "memory/store/store.hpp"
#include "tests/bench/cpu_time.hpp"
#include "tests/bench/mapped_ring.hpp"
#include "tests/bench/ring_drive.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/test_data.hpp"

namespace strata {
namespace {

using bench::cpu_s;
using bench::kPeriod;
using bench::Robot;
using bench::world;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kWarmUp = 40;  // the filter narrows, the middleware allocates

/// When each pose came, and how long the filter itself took for it.
class Poses {
 public:
  explicit Poses(const std::shared_ptr<bus::Participant>& participant)
      : poses_(participant, "/amcl_pose", bus::qos_profile("default"),
               [this](const geometry_msgs::msg::PoseWithCovarianceStamped& pose) {
                 const std::lock_guard lock(mutex_);
                 came_[convert::from_message(pose.header().stamp()).ns] = Clock::now();
               }),
        health_(participant, "/localization_health", bus::qos_profile("default"),
                [this](const strata_msgs::msg::LocalizationHealth& health) {
                  const std::lock_guard lock(mutex_);
                  took_s_[convert::from_message(health.header().stamp()).ns] = health.update_time();
                }) {}
  struct Answer {
    double latency_ms = 0.0;
    double update_ms = 0.0;
  };
  /// Of those that came.
  [[nodiscard]] std::vector<Answer> since(const std::map<std::int64_t, Clock::time_point>& sent) {
    const std::lock_guard lock(mutex_);
    std::vector<Answer> answers;
    for (const auto& [stamp, at] : sent) {
      const auto came = came_.find(stamp);
      const auto took = took_s_.find(stamp);
      if (came == came_.end() || took == took_s_.end()) continue;
      answers.push_back({std::chrono::duration<double, std::milli>(came->second - at).count(),
                         1e3 * took->second});
    }
    return answers;
  }

 private:
  std::mutex mutex_;
  std::map<std::int64_t, Clock::time_point> came_;
  std::map<std::int64_t, double> took_s_;
  bus::Reader<geometry_msgs::msg::PoseWithCovarianceStamped> poses_;
  bus::Reader<strata_msgs::msg::LocalizationHealth> health_;
};

/// Drives at 40 Hz and tells latency and what of it is not the filter's own work.
void drive(benchmark::State& state, Robot& robot) {
  Poses poses(robot.participant);
  robot.tell_mounting();
  if (!robot.is_heard()) return state.SkipWithError("the localizer was not found");
  std::this_thread::sleep_for(std::chrono::seconds(1));
  std::vector<double> added_ms;
  std::vector<double> latency_ms;
  for (auto _ : state) {
    std::map<std::int64_t, Clock::time_point> sent;
    const Clock::time_point start = Clock::now();
    for (std::size_t i = 0; i < world().log.size(); ++i) {
      std::this_thread::sleep_until(start + static_cast<int>(i) * kPeriod);
      const Observation& observation = world().log[i];
      const Clock::time_point handed_over = robot.see(observation);
      if (i >= kWarmUp) sent[observation.scan.stamp.ns] = handed_over;
    }
    std::this_thread::sleep_for(std::chrono::seconds(1));
    const auto answers = poses.since(sent);
    for (const Poses::Answer& answer : answers) {
      latency_ms.push_back(answer.latency_ms);
      added_ms.push_back(answer.latency_ms - answer.update_ms);
    }
    state.counters["lost"] = static_cast<double>(sent.size() - answers.size());
  }
  if (latency_ms.empty()) return state.SkipWithError("no poses came");
  bench::tell(state, added_ms);
  std::sort(latency_ms.begin(), latency_ms.end());
  state.counters["whole_median_ms"] = latency_ms[latency_ms.size() / 2];
}

/// Composed in one process.
void pose_in_process(benchmark::State& state) {
  runtime::Registry registry;
  localizer::register_component(registry);
  Robot robot;
  const auto host = test::make_host(world().localizer(), registry, test::make_participant());
  host->activate();
  drive(state, robot);
}
BENCHMARK(pose_in_process)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

/// `strata run` as a process of its own, on the transport of the argument.
void pose_from_process(benchmark::State& state, bus::Transport transport, const char* name) {
  const test::TemporaryDirectory folder;
  std::ofstream(folder.path() / "localize.yaml")
      << "version: 1\ndomain: " << test::own_domain() << "\ntransport: " << name
      << "\nprocesses: [{name: p, components: [" << world().localizer() << "]}]\n";
  test::ChildProcess child({STRATA_PROGRAM, "run", (folder.path() / "localize.yaml").string()}, {},
                           test::ChildProcess::Errors::kMerged);
  if (child.wait_for_line("process p runs").empty()) {
    return state.SkipWithError("strata run does not run");
  }
  Robot robot(test::make_participant(transport));
  drive(state, robot);
}
BENCHMARK_CAPTURE(pose_from_process, loopback, bus::Transport::kLoopback, "loopback")
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(pose_from_process, shared_memory, bus::Transport::kSharedMemory, "shared_memory")
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();

/// The timescale memory as a process of its own, with a store on disk and somebody who listens to
/// all that it says: its CPU time as a share of one core while scans come at 40 Hz.
void remember(benchmark::State& state) {
  const test::TemporaryDirectory folder;
  std::ofstream(folder.path() / "remember.yaml")
      << "version: 1\ndomain: " << test::own_domain()
      << "\ntransport: shared_memory\nprocesses: [{name: p, components: [{type: "
         "strata::TimescaleMemory, name: memory, parameters: {store: "
      << (folder.path() / "strata.db").string() << "}}]}]\n";
  test::ChildProcess child({STRATA_PROGRAM, "run", (folder.path() / "remember.yaml").string()}, {},
                           test::ChildProcess::Errors::kMerged);
  if (child.wait_for_line("process p runs").empty()) {
    return state.SkipWithError("strata run does not run");
  }
  const auto participant = test::make_participant(bus::Transport::kSharedMemory);
  bus::Writer<strata_msgs::msg::LabeledScan> scans(participant, "/labeled_scan",
                                                   bus::qos_profile("lossless"));
  std::atomic<std::size_t> maps = 0;
  const bus::Reader<strata_msgs::msg::NodeMap> listener(
      participant, "/node_map", bus::qos_profile("latched"), [&](const auto&) { ++maps; });
  if (!scans.raw().wait_for_readers(1, std::chrono::seconds(20))) {
    return state.SkipWithError("the memory was not found");
  }
  for (auto _ : state) {
    const double cpu_before_s = cpu_s(child);
    const Clock::time_point start = Clock::now();
    for (std::size_t i = 0; i < world().log.size(); ++i) {
      std::this_thread::sleep_until(start + static_cast<int>(i) * kPeriod);
      const Observation& seen = world().log[i];
      scans.publish(convert::to_message(PosedScan{seen.run, seen.scan, seen.odom_from_robot, {}},
                                        "map", "laser"));
    }
    const double took_s = std::chrono::duration<double>(Clock::now() - start).count();
    state.counters["core_share"] = (cpu_s(child) - cpu_before_s) / took_s;
    state.counters["scans"] = static_cast<double>(world().log.size());
    state.counters["maps"] = static_cast<double>(maps);
  }
  child.send(SIGINT);
  child.wait();
  const memory::Store store(folder.path() / "strata.db", {.read_only = true});
  state.counters["nodes"] = static_cast<double>(store.load_timescale().nodes().size());
}
BENCHMARK(remember)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

/// Fast DDS alone: one scan from write() to the reader's callback, in one process.
void one_hop(benchmark::State& state) {
  const auto sender = test::make_participant();
  std::mutex mutex;
  std::condition_variable changed;
  std::size_t heard = 0;
  Clock::time_point came;
  const bus::RawReader reader(test::make_participant(), "/scan", "sensor_msgs/msg/LaserScan",
                              bus::qos_profile("sensor_data"), [&](const bus::RawMessage&) {
                                const std::lock_guard lock(mutex);
                                came = Clock::now();
                                ++heard;
                                changed.notify_all();
                              });
  bus::RawWriter writer(sender, "/scan", "sensor_msgs/msg/LaserScan",
                        bus::qos_profile("sensor_data"));
  if (!writer.wait_for_readers(1, std::chrono::seconds(20)) ||
      !reader.wait_for_writers(1, std::chrono::seconds(20))) {
    return state.SkipWithError("nobody listens");
  }
  const auto cdr = convert::to_cdr(convert::to_message(world().log[0].scan, "laser"));
  std::vector<double> each_ms;
  for (auto _ : state) {
    for (std::size_t i = 0; i < bench::kMappedScans; ++i) {
      std::unique_lock lock(mutex);
      const std::size_t before = heard;
      lock.unlock();
      const Clock::time_point begin = Clock::now();
      writer.publish(cdr);
      lock.lock();
      if (!changed.wait_for(lock, std::chrono::seconds(1), [&] { return heard > before; }))
        continue;
      each_ms.push_back(std::chrono::duration<double, std::milli>(came - begin).count());
      lock.unlock();
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  bench::tell(state, each_ms);
}
BENCHMARK(one_hop)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

/// The same from a process of its own, whose scans say when they were handed over.
void one_hop_from_process(benchmark::State& state, bus::Transport transport, const char* name) {
  std::mutex mutex;
  std::vector<double> each_ms;
  const bus::RawReader reader(
      test::make_participant(transport), "/scan", "sensor_msgs/msg/LaserScan",
      bus::qos_profile("sensor_data"), [&](const bus::RawMessage& message) {
        const Clock::time_point came = Clock::now();
        std::int32_t sec = 0;  // of the stamp, which comes first
        std::uint32_t nanosec = 0;
        std::memcpy(&sec, message.cdr.data() + 4, sizeof sec);
        std::memcpy(&nanosec, message.cdr.data() + 8, sizeof nanosec);
        const auto begin = std::chrono::seconds(sec) + std::chrono::nanoseconds(nanosec);
        const std::lock_guard lock(mutex);
        each_ms.push_back(
            std::chrono::duration<double, std::milli>(came.time_since_epoch() - begin).count());
      });
  const std::string count = std::to_string(bench::kMappedScans);
  for (auto _ : state) {
    test::ChildProcess sender(
        {STRATA_ROBOT_PROCESS, std::to_string(test::own_domain()), name, "hop", count});
    sender.close_input();
    if (sender.wait_for_line("sent", std::chrono::seconds(60)).empty()) {
      return state.SkipWithError("the sender was not found");
    }
    std::this_thread::sleep_for(std::chrono::seconds(1));
  }
  const std::lock_guard lock(mutex);
  if (each_ms.empty()) return state.SkipWithError("no scans came");
  bench::tell(state, each_ms);
}
BENCHMARK_CAPTURE(one_hop_from_process, loopback, bus::Transport::kLoopback, "loopback")
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(one_hop_from_process, shared_memory, bus::Transport::kSharedMemory,
                  "shared_memory")
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();

}  // namespace
}  // namespace strata
