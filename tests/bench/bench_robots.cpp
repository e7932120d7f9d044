// SPDX-License-Identifier: Apache-2.0
/// Ten robots on one machine, each a process of its own, with scans of 1,080 beams at 40 Hz,
/// reliable: recorded into one bag, and localized, each robot by a process of its own, as many as
/// the argument says. docs/benchmarks.md has the figures.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>
#include <signal.h>

#include "tests/bench/bag_count.hpp"
#include "tests/bench/cpu_time.hpp"
#include "tests/bench/mapped_ring.hpp"

namespace strata {
namespace {

using bench::cpu_s;
using bench::world;
using test::ChildProcess;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kRobots = 10;
constexpr std::size_t kScans = 800;  // of each robot: 20 s

std::string scope(std::size_t robot) { return "/robot" + std::to_string(robot); }

/// `strata run` of processes that are given as YAML.
class Composition {
 public:
  Composition(const std::string& transport, const std::string& processes) {
    const auto file = folder_.path() / "composition.yaml";
    std::ofstream(file) << "version: 1\ndomain: " << test::own_domain()
                        << "\ntransport: " << transport << "\nprocesses: [" << processes << "]\n";
    child_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{STRATA_PROGRAM, "run", "--quiet", file.string()});
  }
  [[nodiscard]] const ChildProcess& child() const { return *child_; }
  void end() {
    child_->send(SIGINT);
    child_->wait();
  }

 private:
  test::TemporaryDirectory folder_;
  std::unique_ptr<ChildProcess> child_;
};

std::string recorder(const std::string& bag, const std::string& storage) {
  std::string topics;
  for (std::size_t i = 0; i < kRobots; ++i) {
    topics += (i > 0 ? ", '" : "'") + scope(i) + "/scan:sensor_msgs/msg/LaserScan'";
  }
  return "{name: r, components: [{type: strata::Recorder, name: recorder, parameters: {storage: " +
         storage + ", out: " + bag + ", topics: [" + topics + "]}}]}";
}

std::string localizers(std::size_t count) {
  std::string processes;
  for (std::size_t i = 0; i < count; ++i) {
    processes += (i > 0 ? ", {name: l" : "{name: l") + std::to_string(i) + ", components: [" +
                 world().localizer(scope(i)) + "]}";
  }
  return processes;
}

/// What the robots tell at their ends.
struct Told {
  std::size_t sent = 0;
  std::size_t poses = 0;
  long late = 0;
  double median_ms = 0.0;  ///< the largest of the robots'
  double p99_ms = 0.0;
  /// False when a robot said something else, or nothing.
  [[nodiscard]] bool add(const std::string& line) {
    std::size_t own_sent = 0;
    std::size_t own_poses = 0;
    long own_late = 0;
    double own_median_ms = 0.0;
    double own_p99_ms = 0.0;
    constexpr int kNumbers = 5;
    if (std::sscanf(line.c_str(), "sent %zu poses %zu late %ld median %lf p99 %lf", &own_sent,
                    &own_poses, &own_late, &own_median_ms, &own_p99_ms) != kNumbers) {
      return false;
    }
    sent += own_sent;
    poses += own_poses;
    late += own_late;
    median_ms = std::max(median_ms, own_median_ms);
    p99_ms = std::max(p99_ms, own_p99_ms);
    return true;
  }
};

double load() {
  double one_minute = 0.0;
  return getloadavg(&one_minute, 1) == 1 ? one_minute : 0.0;
}

void ten_robots(benchmark::State& state, const char* transport, const char* storage) {
  const auto localized = static_cast<std::size_t>(state.range(0));
  const test::TemporaryDirectory folder;
  const std::string bag = (folder.path() / "bag").string();
  state.counters["load"] = load();
  Composition recording(transport, recorder(bag, storage));
  std::unique_ptr<Composition> localizing;
  if (localized > 0) localizing = std::make_unique<Composition>(transport, localizers(localized));
  std::vector<std::unique_ptr<ChildProcess>> robots;
  for (std::size_t i = 0; i < kRobots; ++i) {
    const bool is_localized = i < localized;
    robots.push_back(std::make_unique<ChildProcess>(std::vector<std::string>{
        STRATA_ROBOT_PROCESS, std::to_string(test::own_domain()), transport, "drive", scope(i),
        std::to_string(kScans), is_localized ? "2" : "1", is_localized ? "located" : "alone"}));
  }
  for (const auto& robot : robots) {
    if (robot->wait_for_line("ready", std::chrono::seconds(90)).empty()) {
      return state.SkipWithError("a robot was not heard");
    }
  }
  Told located;
  Told alone;
  for (auto _ : state) {
    const Clock::time_point begin = Clock::now();
    const double recording_before_s = cpu_s(recording.child());
    const double localizing_before_s = localizing ? cpu_s(localizing->child()) : 0.0;
    for (const auto& robot : robots) robot->close_input();
    for (std::size_t i = 0; i < kRobots; ++i) {
      Told& told = i < localized ? located : alone;
      if (!told.add(robots[i]->wait_for_line("sent", std::chrono::seconds(90)))) {
        return state.SkipWithError("a robot did not tell what became of its scans");
      }
    }
    const double took_s = std::chrono::duration<double>(Clock::now() - begin).count();
    state.counters["recorder_core"] = (cpu_s(recording.child()) - recording_before_s) / took_s;
    if (localizing) {
      state.counters["core_per_localizer"] = (cpu_s(localizing->child()) - localizing_before_s) /
                                             took_s / static_cast<double>(localized);
      localizing->end();
    }
    std::this_thread::sleep_for(std::chrono::seconds(1));
    recording.end();
  }
  const auto sent = static_cast<double>(kRobots * kScans);
  state.counters["recorded_lost"] = sent - static_cast<double>(bench::messages_in(bag));
  state.counters["poses_asked"] = static_cast<double>(located.sent);
  state.counters["poses_lost"] = static_cast<double>(located.sent - located.poses);
  state.counters["poses_late"] = static_cast<double>(located.late);
  state.counters["median_ms"] = located.median_ms;
  state.counters["p99_ms"] = located.p99_ms;
}
BENCHMARK_CAPTURE(ten_robots, shared_memory_sqlite3, "shared_memory", "sqlite3")
    ->Arg(0)
    ->Arg(1)
    ->Arg(2)
    ->Arg(4)
    ->Arg(6)
    ->Arg(8)
    ->Arg(10)
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(ten_robots, shared_memory_mcap, "shared_memory", "mcap")
    ->Arg(0)
    ->Arg(10)
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(ten_robots, loopback_mcap, "loopback", "mcap")
    ->Arg(0)
    ->Arg(10)
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime();

}  // namespace
}  // namespace strata
