// SPDX-License-Identifier: Apache-2.0
/// A day of messages to a robot's process, as fast as it takes them, beside three processes on
/// Cyclone DDS, two of them nodes of ROS 2, that start and end all the time, every second time
/// without a goodbye. All of them
/// multicast, as ROS 2 does by default, on a loopback of their own:
///
///     unshare -rn bash -c "ip link set lo up multicast on; ip route add default dev lo;
///                          STRATA_BENCH_HOURS=6 bench_company"
///
/// docs/networks.md has the figures. STRATA_BENCH_HOURS: of the robot's own time, other than 24.
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "strata_idl/geometry_msgs.h"
#include <benchmark/benchmark.h>
#include <net/if.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/bench/endless_drive.hpp"
#include "tests/bench/mapped_ring.hpp"
#include "tests/bench/ring_drive.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/network/cyclone_configuration.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/test_data.hpp"

namespace strata {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kAhead = 5;               // scans on their way, at most
constexpr std::size_t kScansInAQuarter = 4500;  // of an hour

double wanted_hours() {
  const char* const wanted = std::getenv("STRATA_BENCH_HOURS");
  return wanted != nullptr ? std::atof(wanted) : 24.0;
}

bool loopback_multicasts() {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ifreq request = {};
  std::strcpy(request.ifr_name, "lo");
  const bool is_known = ioctl(socket, SIOCGIFFLAGS, &request) == 0;
  close(socket);
  return is_known && (request.ifr_flags & IFF_MULTICAST) != 0;
}

/// What a process holds.
struct Held {
  double resident_mb = 0.0;
  double max_resident_mb = 0.0;
  double threads = 0.0;
  double files = 0.0;
};

Held held_by(pid_t pid) {
  const std::filesystem::path process = "/proc/" + std::to_string(pid);
  Held held;
  std::ifstream status(process / "status");
  for (std::string word; status >> word;) {
    if (word == "VmRSS:") status >> held.resident_mb;
    if (word == "VmHWM:") status >> held.max_resident_mb;
    if (word == "Threads:") status >> held.threads;
  }
  held.resident_mb /= 1024.0;
  held.max_resident_mb /= 1024.0;
  std::error_code gone;
  const std::filesystem::directory_iterator files(process / "fd", gone);
  held.files = static_cast<double>(std::distance(files, {}));
  return held;
}

/// One process after the other, each until it has heard the robot.
class Visitors {
 public:
  /// arguments: of cyclone_peer, after the domain.
  Visitors(std::vector<std::string> arguments, std::string heard)
      : command_(std::move(arguments)), heard_(std::move(heard)) {
    command_.insert(command_.begin(), {STRATA_CYCLONE_PEER, std::to_string(test::own_domain())});
    thread_ = std::thread([this] { come_and_go(); });
  }
  ~Visitors() { end(); }
  Visitors(const Visitors&) = delete;
  Visitors& operator=(const Visitors&) = delete;
  void end() {
    is_over_ = true;
    if (thread_.joinable()) thread_.join();
  }
  [[nodiscard]] int came() const { return came_; }
  [[nodiscard]] int deaf() const { return deaf_; }

 private:
  void come_and_go() {
    while (!is_over_) {
      test::ChildProcess visitor(command_, {environment_});
      ++came_;
      if (visitor.wait_for_line(heard_).empty()) ++deaf_;
      if (came_ % 2 == 0) visitor.kill_hard();
      visitor.close_input();
      (void)visitor.rest();  // or it would wait for somebody to read it
    }
  }
  std::vector<std::string> command_;
  std::string heard_;
  const std::string environment_ = test::cyclone_configuration(test::CycloneNetwork::kLoopback, {});
  std::atomic<bool> is_over_{false};
  std::atomic<int> came_{0};
  std::atomic<int> deaf_{0};
  std::thread thread_;
};

void tell(benchmark::State& state, const std::string& when, const Held& held) {
  state.counters["mb_" + when] = held.resident_mb;
  state.counters["threads_" + when] = held.threads;
  state.counters["files_" + when] = held.files;
}

/// Drives until the robot has had its hours; how many poses came.
std::size_t drive(benchmark::State& state, bench::Robot& robot, test::ChildProcess& child) {
  std::atomic<std::size_t> poses = 0;
  const bus::Reader<geometry_msgs::msg::PoseWithCovarianceStamped> reader(
      robot.participant, "/amcl_pose", bus::qos_profile("default"), [&](const auto&) { ++poses; });
  bench::EndlessDrive drive;
  std::size_t due = 0;
  bool is_half_way = false;
  while (drive.hours() < wanted_hours() && child.runs()) {
    robot.see(drive.next());
    ++due;
    const Clock::time_point until = Clock::now() + std::chrono::seconds(1);
    while (poses + kAhead < due && Clock::now() < until) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    if (poses + kAhead < due) due = poses;  // some were lost
    if (drive.count() == kScansInAQuarter) tell(state, "after_a_quarter", held_by(child.pid()));
    if (!is_half_way && drive.hours() >= 0.5 * wanted_hours()) {
      is_half_way = true;
      tell(state, "half_way", held_by(child.pid()));
    }
  }
  state.counters["hours"] = drive.hours();
  state.counters["scans"] = static_cast<double>(drive.count());
  return poses;
}

void localizing_in_company(benchmark::State& state) {
  if (!loopback_multicasts()) {
    return state.SkipWithError("lo does not multicast: see the command at the head of this file");
  }
  const test::TemporaryDirectory folder;
  std::ofstream(folder.path() / "localize.yaml")
      << "version: 1\ndomain: " << test::own_domain()
      << "\ntransport: default\nprocesses: [{name: p, components: [" << bench::world().localizer()
      << "]}]\n";
  test::ChildProcess child({STRATA_PROGRAM, "run", (folder.path() / "localize.yaml").string()}, {},
                           test::ChildProcess::Errors::kMerged);
  if (child.wait_for_line("process p runs").empty()) {
    return state.SkipWithError("strata run does not run");
  }
  bench::Robot robot(test::make_participant(bus::Transport::kDefault), "", "default");
  robot.tell_mounting();
  if (!robot.is_heard()) return state.SkipWithError("the localizer was not found");
  // Two, since readers of one topic that share a group are what ended robots.
  Visitors nodes({"ros_node", "/", "visitor"}, "node / localizer");
  Visitors others({"ros_node", "/", "other"}, "node / localizer");
  Visitors listeners({"late_pose", "rt/amcl_pose"}, "pose");
  for (auto _ : state) state.counters["poses"] = static_cast<double>(drive(state, robot, child));
  nodes.end();
  others.end();
  listeners.end();
  const Held held = held_by(child.pid());
  tell(state, "at_the_end", held);
  state.counters["most_mb"] = held.max_resident_mb;
  state.counters["nodes_came"] = nodes.came() + others.came();
  state.counters["listeners_came"] = listeners.came();
  state.counters["heard_nothing"] = nodes.deaf() + others.deaf() + listeners.deaf();
  if (!child.runs()) return state.SkipWithError("the robot's process has ended");
  child.send(SIGINT);
  const std::string said = child.rest();
  const int code = child.wait();
  std::cout << said;
  if (code != 0) state.SkipWithError("the robot's process did not end well");
}
BENCHMARK(localizing_in_company)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

}  // namespace
}  // namespace strata
