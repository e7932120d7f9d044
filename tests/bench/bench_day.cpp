// SPDX-License-Identifier: Apache-2.0
/// A day of messages over DDS, as fast as they go: a robot drives round a block for 25 hours of its
/// own time, and the process that maps, learns or records tells what it holds in memory, and how
/// that grows after the first hour. One benchmark a run, since memory is the process's:
///
///     STRATA_BENCH_HOURS=6 bench_day --benchmark_filter=topology
///
/// docs/benchmarks.md has the figures. STRATA_BENCH_HOURS: other than 25.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <thread>

#include <benchmark/benchmark.h>

#include "components/beam_filter/register.hpp"
#include "components/convert/map_messages.hpp"
#include "components/maps/earlier_runs.hpp"
#include "components/patch_learner/register.hpp"
#include "components/recorder/register.hpp"
#include "components/scan_matcher/register.hpp"
#include "components/timescale_memory/register.hpp"
#include "components/topology_mapper/register.hpp"
#include "core/grid/counting_map.hpp"
#include "tests/bench/bag_count.hpp"
#include "tests/bench/endless_drive.hpp"
#include "tests/bench/resident_memory.hpp"
#include "tests/bench/ring_drive.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata {
namespace {

constexpr std::size_t kAhead = 5;           // scans on their way, at most
constexpr std::size_t kScansASample = 900;  // 3 minutes

double wanted_hours() {
  const char* const wanted = std::getenv("STRATA_BENCH_HOURS");
  return wanted != nullptr ? std::atof(wanted) : 25.0;
}

/// Messages that wait for the component for which most do: in a process that falls behind they grow
/// without end.
std::uint64_t waiting_for(const runtime::Host& host) {
  std::uint64_t most = 0;
  for (const auto& component : host.components()) {
    const runtime::MessageCounts counts = component->counts();
    most = std::max(most, counts.received - std::min(counts.received, counts.done()));
  }
  return most;
}

/// As mapping.yaml does, with a folder that is saved as it grows, and patches within a budget that
/// is used up within the first hours.
void mapping(benchmark::State& state) {
  runtime::Registry registry;
  scan_matcher::register_component(registry);
  beam_filter::register_component(registry);
  patch_learner::register_component(registry);
  const test::TemporaryDirectory folder;
  bench::Robot robot;
  std::atomic<std::size_t> answers = 0;
  bus::Reader<strata_msgs::msg::LabeledScan> reader(
      robot.participant, "/labeled_scan", bus::qos_profile("default"),
      [&](const strata_msgs::msg::LabeledScan&) { ++answers; });
  std::atomic<std::size_t> told_maps = 0;
  bus::Reader<nav_msgs::msg::OccupancyGrid> map_reader(
      robot.participant, "/map", bus::qos_profile("latched"),
      [&](const nav_msgs::msg::OccupancyGrid&) { ++told_maps; });
  const auto host = test::make_host(
      "{type: strata::ScanMatcher, name: matcher, parameters: {maps: {folder: '" +
          (folder.path() / "maps").string() +
          "'}}}, {type: strata::BeamFilter, name: filter}, {type: strata::PatchLearner, name: "
          "learner, parameters: {online: {learner: {memory_mb: 64}}}}",
      registry, test::make_participant());
  host->activate();
  robot.tell_mounting();
  if (!robot.is_heard()) return state.SkipWithError("the components were not found");
  std::this_thread::sleep_for(std::chrono::seconds(1));
  bench::EndlessDrive drive;
  bench::MemoryCourse course;
  std::size_t sent = 0;
  std::uint64_t most_waited = 0;
  for (auto _ : state) {
    while (drive.hours() < wanted_hours()) {
      robot.see(drive.next());
      ++sent;
      const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(1);
      while (answers + kAhead < sent && std::chrono::steady_clock::now() < until) {
        std::this_thread::sleep_for(std::chrono::microseconds(100));
      }
      while (waiting_for(*host) > kAhead) {
        most_waited = std::max(most_waited, waiting_for(*host));
        std::this_thread::sleep_for(std::chrono::microseconds(100));
      }
      if (answers + kAhead < sent) sent = answers;  // some were lost
      if (drive.count() % kScansASample == 0) {
        host->tick();
        course.sample(drive.hours());
      }
    }
  }
  course.tell(state);
  state.counters["scans"] = static_cast<double>(answers.load());
  state.counters["maps"] = static_cast<double>(told_maps.load());
  state.counters["messages that waited at most"] = static_cast<double>(most_waited);
  for (const auto& component : host->components()) component->deactivate();
  state.counters["scans saved"] =
      static_cast<double>(maps::read_earlier_runs(folder.path() / "maps").scans.size());
}
BENCHMARK(mapping)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

/// Works on what was published: a component that is active already does nothing more for it than
/// to wait for its turn, behind the messages that came before.
void catch_up(runtime::Host& host) {
  host.tick();
  host.activate();
}

/// Hands the drive over scan by scan, with few of them on their way.
void drive_with(benchmark::State& state, runtime::Host& host, bench::EndlessDrive& drive,
                const std::function<void(const Observation&)>& see) {
  bench::MemoryCourse course;
  for (auto _ : state) {
    while (drive.hours() < wanted_hours()) {
      see(drive.next());
      if (drive.count() % kAhead == 0) catch_up(host);
      if (drive.count() % kScansASample == 0) course.sample(drive.hours());
    }
  }
  course.tell(state);
  state.counters["scans"] = static_cast<double>(drive.count());
  state.counters["dropped"] = static_cast<double>(host.components().front()->counts().dropped);
}

/// A component that takes scans whose poses are known, here the true ones.
void drive_with_poses(benchmark::State& state, runtime::Host& host,
                      const std::shared_ptr<bus::Participant>& participant,
                      bench::EndlessDrive& drive) {
  bus::Writer<strata_msgs::msg::LabeledScan> scans(participant, "/labeled_scan",
                                                   bus::qos_profile("lossless"));
  host.activate();
  if (!scans.raw().wait_for_readers(1, std::chrono::seconds(20))) {
    return state.SkipWithError("the component was not found");
  }
  drive_with(state, host, drive, [&](const Observation& seen) {
    scans.publish(convert::to_message(PosedScan{0, seen.scan, drive.truth(), {}}, "map", "laser"));
  });
}

/// The map of the first recording, as a beam filter would tell it.
ReflectionGrid map_of_a_round() {
  bench::EndlessDrive drive;
  CountingMap counts(0.05);
  for (int i = 0; i < 400; ++i) {
    const Observation& seen = drive.next();
    counts.add(PosedScan{0, seen.scan, drive.truth(), {}});
  }
  return counts.reflection();
}

/// With a budget that is used up within the first hour, in a corridor with a box that comes and
/// goes.
void learning(benchmark::State& state) {
  runtime::Registry registry;
  patch_learner::register_component(registry);
  const auto participant = test::make_participant();
  bus::Writer<strata_msgs::msg::ReflectionGrid> map(participant, "/reflection_filtered",
                                                    bus::qos_profile("latched"));
  map.publish(convert::to_message(map_of_a_round()));
  std::atomic<std::size_t> submaps = 0;
  bus::Reader<strata_msgs::msg::PatchMap> learned(
      participant, "/patch_map", bus::qos_profile("latched"),
      [&](const strata_msgs::msg::PatchMap& patches) { submaps = patches.submaps().size(); });
  const auto host = test::make_host(
      "{type: strata::PatchLearner, name: learner, parameters: {online: {enabled: true, learner: "
      "{memory_mb: 16}}}}",
      registry, test::make_participant());
  bench::EndlessDrive drive(true);
  drive_with_poses(state, *host, participant, drive);
  if (submaps == 0) return state.SkipWithError("nothing was learned, so nothing could grow");
  state.counters["sub-maps"] = static_cast<double>(submaps.load());
}
BENCHMARK(learning)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

/// With a store on disk.
void remembering(benchmark::State& state) {
  runtime::Registry registry;
  timescale_memory::register_component(registry);
  const test::TemporaryDirectory folder;
  const auto host =
      test::make_host("{type: strata::TimescaleMemory, name: memory, parameters: {store: " +
                          (folder.path() / "strata.db").string() + "}}",
                      registry, test::make_participant());
  bench::EndlessDrive drive(true);
  drive_with_poses(state, *host, test::make_participant(), drive);
}
BENCHMARK(remembering)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

void drive_with_sensors(benchmark::State& state, runtime::Host& host) {
  bench::Robot robot;
  host.activate();
  robot.tell_mounting();
  if (!robot.scans.raw().wait_for_readers(1, std::chrono::seconds(20))) {
    return state.SkipWithError("the component was not found");
  }
  bench::EndlessDrive drive;
  drive_with(state, host, drive, [&](const Observation& seen) { robot.see(seen); });
}

/// With a budget that is used up within the first hour: the map is complete then.
void topology(benchmark::State& state) {
  runtime::Registry registry;
  topology_mapper::register_component(registry);
  const auto participant = test::make_participant();
  std::atomic<std::size_t> visits = 0;
  bus::Reader<strata_msgs::msg::Topologies> posterior(
      participant, "/topologies", bus::qos_profile("latched"),
      [&](const strata_msgs::msg::Topologies& message) { visits = message.visits().size(); });
  const auto host = test::make_host(
      "{type: strata::TopologyMapper, name: topology, parameters: {keep: {memory_mb: 8}}}",
      registry, test::make_participant());
  drive_with_sensors(state, *host);
  if (visits == 0) return state.SkipWithError("no landmark was found");
  state.counters["visits"] = static_cast<double>(visits.load());
}
BENCHMARK(topology)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

/// MCAP, its chunks compressed with zstd; a file holds an hour of the robot's time, since what MCAP
/// ends a file with is kept until then. By size: messages are stamped by the clock on the wall.
void recording(benchmark::State& state) {
  runtime::Registry registry;
  recorder::register_component(registry);
  bench::EndlessDrive sample;
  const auto scan = convert::to_cdr(convert::to_message(sample.next().scan, "laser"));
  const auto odometry = convert::to_cdr(nav_msgs::msg::Odometry());
  const double hour_mb =
      static_cast<double>((scan.size() + odometry.size()) * 20 * kScansASample) / 1e6;
  const test::TemporaryDirectory folder;
  auto host = test::make_host(
      "{type: strata::Recorder, name: recorder, parameters: {storage: mcap, compression: zstd, "
      "split_mb: " +
          std::to_string(hour_mb) + ", out: " + (folder.path() / "bag").string() +
          ", topics: ['/scan:sensor_msgs/msg/LaserScan', '/odom:nav_msgs/msg/Odometry']}}",
      registry, test::make_participant());
  drive_with_sensors(state, *host);
  host.reset();
  state.counters["recorded"] = static_cast<double>(bench::messages_in(folder.path() / "bag"));
  const std::filesystem::directory_iterator files(folder.path() / "bag");
  state.counters["files"] = static_cast<double>(std::distance(files, {}) - 1);  // and metadata.yaml
}
BENCHMARK(recording)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

}  // namespace
}  // namespace strata
