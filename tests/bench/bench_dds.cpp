// SPDX-License-Identifier: Apache-2.0
/// What DDS adds: from a scan on /scan to the robot's pose on /amcl_pose, composed in one process
/// and with a process of its own, beside Fast DDS alone; what the timescale memory takes of a core;
/// and how ten robots are recorded. docs/benchmarks.md has the figures.
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>
#include <signal.h>
#include <unistd.h>

#include "components/localizer/register.hpp"
#include "components/log/bag.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/slam/slam.hpp"
#include "memory/store/store.hpp"
#include "tests/bench/ring_drive.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/test_data.hpp"

namespace strata {
namespace {

using bench::kPeriod;
using bench::Robot;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kScans = 1'000;
constexpr std::size_t kWarmUp = 40;  // the filter narrows, the middleware allocates
constexpr std::size_t kRobots = 10;
constexpr std::size_t kRecorded = 400;  // scans of each robot: 10 s

/// Where the robot drives, and the maps of it that `strata learn` would write.
struct World {
  test::TemporaryDirectory folder;
  std::vector<Observation> log = bench::ring_log();
  World() {
    log.resize(kScans);
    slam::Slam slam(slam::SlamConfig{});
    for (const Observation& observation : log) (void)slam.add(observation);
    maps::write_grid_maps(folder.path(), slam.finish());
  }
  [[nodiscard]] std::string localizer() const {
    return "{type: strata::Localizer, name: localizer, parameters: {maps: " +
           folder.path().string() + ", model: filtered, start: {pose: [" +
           std::to_string(log[0].odom_from_robot.x) + ", " +
           std::to_string(log[0].odom_from_robot.y) + ", " +
           std::to_string(log[0].odom_from_robot.theta) + "]}}}";
  }
};

const World& world() {
  static const World made;
  return made;
}

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

/// CPU time of a process so far.
double cpu_s(pid_t pid) {
  std::ifstream in("/proc/" + std::to_string(pid) + "/stat");
  std::string field;
  std::getline(in, field, ')');  // the name may hold blanks
  double ticks = 0.0;
  for (int i = 3; in >> field && i <= 15; ++i) {
    if (i >= 14) ticks += std::stod(field);  // utime, stime [proc(5)]
  }
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

/// ... of a program with the processes that it started.
double cpu_s(const test::ChildProcess& child) {
  double sum = cpu_s(child.pid());
  for (const pid_t pid : child.children()) sum += cpu_s(pid);
  return sum;
}

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
    for (std::size_t i = 0; i < kScans; ++i) {
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

/// Ten robots at 40 Hz, reliable, into one bag: how many messages it holds of those sent.
void record_ten_robots(benchmark::State& state, const char* storage) {
  const test::TemporaryDirectory folder;
  const auto topic = [](std::size_t robot) { return "/robot" + std::to_string(robot) + "/scan"; };
  std::string topics;
  for (std::size_t i = 0; i < kRobots; ++i) {
    topics += (i > 0 ? ", '" : "'") + topic(i) + ":sensor_msgs/msg/LaserScan'";
  }
  const auto bag = folder.path() / "bag";
  std::ofstream(folder.path() / "record.yaml")
      << "version: 1\ndomain: " << test::own_domain()
      << "\ntransport: shared_memory\nprocesses: [{name: p, components: [{type: strata::Recorder, "
         "name: recorder, parameters: {storage: "
      << storage << ", out: " << bag.string() << ", topics: [" << topics << "]}}]}]\n";
  test::ChildProcess child({STRATA_PROGRAM, "run", (folder.path() / "record.yaml").string()}, {},
                           test::ChildProcess::Errors::kMerged);
  if (child.wait_for_line("process p runs").empty()) {
    return state.SkipWithError("strata run does not run");
  }
  const auto participant = test::make_participant(bus::Transport::kSharedMemory);
  std::vector<std::unique_ptr<bus::RawWriter>> writers;
  for (std::size_t i = 0; i < kRobots; ++i) {
    writers.push_back(std::make_unique<bus::RawWriter>(
        participant, topic(i), "sensor_msgs/msg/LaserScan", bus::qos_profile("default")));
    if (!writers.back()->wait_for_readers(1, std::chrono::seconds(20))) {
      return state.SkipWithError("the recorder was not found");
    }
  }
  const auto cdr = convert::to_cdr(convert::to_message(world().log[0].scan, "laser"));
  for (auto _ : state) {
    const Clock::time_point start = Clock::now();
    for (std::size_t i = 0; i < kRecorded; ++i) {
      std::this_thread::sleep_until(start + static_cast<int>(i) * kPeriod);
      for (const auto& writer : writers) writer->publish(cdr);
    }
    std::this_thread::sleep_for(std::chrono::seconds(2));
    child.send(SIGINT);
    child.wait();
  }
  const auto reader = log::BagReader::open(bag);
  log::BagMessage message;
  std::size_t held = 0;
  while (reader->next(message)) ++held;
  state.counters["sent"] = static_cast<double>(kRobots * kRecorded);
  state.counters["lost"] = static_cast<double>(kRobots * kRecorded) - static_cast<double>(held);
}
BENCHMARK_CAPTURE(record_ten_robots, sqlite3, "sqlite3")
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(record_ten_robots, mcap, "mcap")
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();

}  // namespace
}  // namespace strata
