// SPDX-License-Identifier: Apache-2.0
/// One end of a topic, on a host of its own:
///
///   network_peer TRANSPORT scans COUNT HZ [QOS [told]]
///                                                waits for a reader and, when told, for a line of
///                                                input; publishes numbered scans, "done"
///   network_peer TRANSPORT hear COUNT [QOS]      "met" once a writer is matched; "heard N of M, K
///                                                in order" after scan M = COUNT - 1
///   network_peer TRANSPORT map CELLS             publishes a square map, latched
///   network_peer TRANSPORT get-map               "map CELLS CHECKSUM" of the one that comes
///   network_peer TRANSPORT meet NUMBER           publishes its number, latched, and reads those of
///                                                others: "met OTHER" for each
///
/// TRANSPORT: a transport's name, or "environment" for what ROS 2's variables say. QOS: a profile's
/// name. Says "ready" once it has its endpoint, or is about to meet others; ends when its input
/// does.
#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <iostream>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "components/bus/endpoint.hpp"
#include "components/bus/environment.hpp"
#include "components/bus/node.hpp"

namespace strata::test {
namespace {

using nav_msgs::msg::OccupancyGrid;
using sensor_msgs::msg::LaserScan;

constexpr std::size_t kBeams = 1080;
constexpr auto kPatience = std::chrono::seconds(60);

/// From any thread.
void say(const std::string& line) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  std::cout << line << std::endl;
}

void publish_scans(const std::shared_ptr<bus::Participant>& participant, int count, double hertz,
                   const std::string& qos, bool when_told) {
  bus::Writer<LaserScan> writer(participant, "/scan", bus::qos_profile(qos));
  say("ready");
  if (!writer.raw().wait_for_readers(1, kPatience)) return;
  if (std::string line; when_told && !std::getline(std::cin, line)) return;
  LaserScan scan;
  scan.ranges().assign(kBeams, 1.0F);
  auto due = std::chrono::steady_clock::now();
  for (int i = 0; i < count; ++i) {
    scan.header().stamp().sec(i);
    writer.publish(scan);
    due += std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(1.0 / hertz));
    std::this_thread::sleep_until(due);
  }
  say("done");
  while (std::cin.get() != EOF) {
  }
}

void hear_scans(const std::shared_ptr<bus::Participant>& participant, int count,
                const std::string& qos) {
  std::atomic<int> heard{0};
  std::atomic<int> in_order{0};
  std::atomic<bool> has_met{false};
  bus::Reader<LaserScan> reader(
      participant, "/scan", bus::qos_profile(qos),
      [&](const LaserScan& scan) {
        const int number = scan.header().stamp().sec();
        const bool is_whole = scan.ranges().size() == kBeams;
        if (is_whole && number == heard) ++in_order;
        ++heard;
        if (number != count - 1) return;
        say("heard " + std::to_string(heard) + " of " + std::to_string(count) + ", " +
            std::to_string(in_order) + " in order");
      },
      [&] {
        if (!has_met.exchange(true)) say("met");
      });
  say("ready");
  while (std::cin.get() != EOF) {
  }
}

std::uint32_t checksum(const OccupancyGrid& map) {
  std::uint32_t sum = 2166136261U;
  for (const auto cell : map.data()) sum = (sum ^ static_cast<std::uint8_t>(cell)) * 16777619U;
  return sum;
}

std::string description(const OccupancyGrid& map) {
  return "map " + std::to_string(map.info().width()) + " " + std::to_string(checksum(map));
}

void publish_map(const std::shared_ptr<bus::Participant>& participant, std::uint32_t cells) {
  bus::Writer<OccupancyGrid> writer(participant, "/map", bus::qos_profile("latched"));
  OccupancyGrid map;
  map.info().width(cells);
  map.info().height(cells);
  map.data().resize(std::size_t{cells} * cells);
  for (std::size_t i = 0; i < map.data().size(); ++i) {
    map.data()[i] = static_cast<std::int8_t>((i * 2654435761U >> 13U) % 101);
  }
  writer.publish(map);
  say(description(map));
  say("ready");
  while (std::cin.get() != EOF) {
  }
}

void get_map(const std::shared_ptr<bus::Participant>& participant) {
  bus::Reader<OccupancyGrid> reader(participant, "/map", bus::qos_profile("latched"),
                                    [](const OccupancyGrid& map) { say(description(map)); });
  say("ready");
  while (std::cin.get() != EOF) {
  }
}

void meet(const std::shared_ptr<bus::Participant>& participant, std::uint32_t number) {
  say("ready");  // nobody is met before that
  const auto qos = bus::qos_profile("latched");
  bus::Reader<OccupancyGrid> reader(participant, "/meet", qos, [&](const OccupancyGrid& other) {
    if (other.info().width() != number) say("met " + std::to_string(other.info().width()));
  });
  bus::Writer<OccupancyGrid> writer(participant, "/meet", qos);
  OccupancyGrid own;
  own.info().width(number);
  writer.publish(own);
  while (std::cin.get() != EOF) {
  }
}

int run(int argc, char** argv) {
  if (argc < 3) return 2;
  bus::ParticipantOptions options = bus::options_from_environment();
  const std::string transport = argv[1];
  if (transport != "environment") options.transport = bus::transport_from_name(transport);
  const auto participant = std::make_shared<bus::Participant>(options);
  const std::string role = argv[2];
  const bus::Node node(participant, "/", "peer");
  if (role == "scans" && argc >= 5) {
    publish_scans(participant, std::stoi(argv[3]), std::stod(argv[4]),
                  argc > 5 ? argv[5] : "default", argc > 6 && std::string(argv[6]) == "told");
  } else if (role == "hear" && argc >= 4) {
    hear_scans(participant, std::stoi(argv[3]), argc > 4 ? argv[4] : "default");
  } else if (role == "meet" && argc == 4) {
    meet(participant, static_cast<std::uint32_t>(std::stoul(argv[3])));
  } else if (role == "map" && argc == 4) {
    publish_map(participant, static_cast<std::uint32_t>(std::stoul(argv[3])));
  } else if (role == "get-map") {
    get_map(participant);
  } else {
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace strata::test

int main(int argc, char** argv) { return strata::test::run(argc, argv); }
