// SPDX-License-Identifier: Apache-2.0
// The figures of docs/networks.md, on hosts of their own; needs what tests/network needs.
//
//   network_figures large_map         how long a latched map of 4 MB takes where frames are lost
//   network_figures several_readers   what readers of Cyclone DDS on another host cost
#include <chrono>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "tests/network/cyclone_configuration.hpp"
#include "tests/network/virtual_network.hpp"

namespace {

using namespace strata::test;
using Process = std::unique_ptr<ChildProcess>;

constexpr auto kPatience = std::chrono::seconds(60);

Process ready(Process process) {
  if (process->wait_for_line("ready", kPatience) != "ready") {
    throw strata::Error("a process of the figure", "is not ready", "see what it says: rest()");
  }
  return process;
}

Process peer(const VirtualNetwork& network, std::size_t host, const std::string& transport,
             const std::vector<std::string>& arguments) {
  std::vector<std::string> command = {STRATA_NETWORK_PEER, transport};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return ready(network.run(host, command));
}

void large_map() {
  for (const char* transport : {"default", "wifi"}) {
    for (const double loss : {0.0, 0.01, 0.02, 0.05, 0.1}) {
      VirtualNetwork network(2);
      network.hub().set({loss, std::chrono::milliseconds(50)});
      const Process server = peer(network, 0, transport, {"map", "2000"});
      const auto begin = std::chrono::steady_clock::now();
      const Process client = peer(network, 1, transport, {"get-map"});
      const bool is_there = !client->wait_for_line("map", kPatience).empty();
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
      std::cout << transport << ", " << 100.0 * loss
                << "% lost: " << (is_there ? "there after " : "not there after ") << took.count()
                << " s\n";
    }
  }
}

#ifdef STRATA_CYCLONE_PEER
/// Each reader gets a copy of its own.
void several_readers() {
  for (const std::size_t readers : {1U, 2U, 3U, 4U}) {
    VirtualNetwork network(2);
    std::vector<Process> listeners;
    for (std::size_t i = 0; i < readers; ++i) {
      listeners.push_back(
          ready(network.run(1, {STRATA_CYCLONE_PEER, "0", "hear", "200"},
                            {cyclone_configuration(CycloneNetwork::kDevices, {"eth0"})})));
    }
    const std::uint64_t before = network.hub().carried_bytes();
    const Process talker = peer(network, 0, "default", {"scans", "200", "20", "tf_static"});
    for (const Process& listener : listeners) (void)listener->wait_for_line("heard");
    std::cout << readers << " readers on another host: "
              << static_cast<double>(network.hub().carried_bytes() - before) / 200.0
              << " bytes a scan of 1,080 beams\n";
  }
}
#endif

}  // namespace

int main(int argc, char** argv) {
  const std::string name = argc == 2 ? argv[1] : "";
  try {
    if (name == "large_map") return large_map(), 0;
#ifdef STRATA_CYCLONE_PEER
    if (name == "several_readers") return several_readers(), 0;
#endif
  } catch (const std::exception& error) {
    std::cerr << "network_figures: error: " << error.what() << "\n";
    return 1;
  }
  std::cerr << "usage: network_figures large_map | several_readers (with Cyclone DDS)\n";
  return 2;
}
