// SPDX-License-Identifier: Apache-2.0
#include "tests/network/virtual_network.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "core/base/error.hpp"

namespace strata::test {
namespace {

std::string device(std::size_t network) { return "eth" + std::to_string(network); }

constexpr const char* kRemedy = "run as root where namespaces and TAP devices are allowed";

/// A TAP device inside the network of that process; -1 when that is not allowed.
int make_tap(pid_t process, const std::string& device_name) {
  int tap = -1;
  // setns is for one thread only, so it is this one's whole life.
  std::thread([&] {
    const std::string network = "/proc/" + std::to_string(process) + "/ns/net";
    const int file = open(network.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0 || setns(file, CLONE_NEWNET) != 0) return;
    close(file);
    tap = open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC);
    ifreq request{};
    request.ifr_flags = IFF_TAP | IFF_NO_PI;
    std::strncpy(request.ifr_name, device_name.c_str(), IFNAMSIZ - 1);
    if (tap >= 0 && ioctl(tap, TUNSETIFF, &request) != 0) {
      close(tap);
      tap = -1;
    }
  }).join();
  return tap;
}

std::vector<std::string> on_host(pid_t process, const std::vector<std::string>& command) {
  std::vector<std::string> words = {"nsenter", "--target", std::to_string(process), "--net",
                                    "--mount"};
  words.insert(words.end(), command.begin(), command.end());
  return words;
}

}  // namespace

std::string VirtualNetwork::address(std::size_t host, std::size_t network) {
  return "10.77." + std::to_string(network) + "." + std::to_string(host + 1);
}

VirtualNetwork::VirtualNetwork(std::size_t hosts, std::size_t networks) {
  std::vector<std::vector<int>> taps(networks);
  for (std::size_t i = 0; i < hosts; ++i) {
    // `cat` ends when we do. Hosts do not share memory, so each has its own /dev/shm.
    holders_.push_back(std::make_unique<ChildProcess>(
        std::vector<std::string>{"unshare", "--net", "--mount", "sh", "-c",
                                 "mount -t tmpfs tmpfs /dev/shm && echo ready && exec cat"}));
    if (holders_.back()->wait_for_line("ready").empty()) {
      throw OutputError("namespaces", "are not allowed here", kRemedy);
    }
    set_up(i, "ip link set lo up");
    for (std::size_t n = 0; n < networks; ++n) {
      taps[n].push_back(make_tap(holders_.back()->pid(), device(n)));
      if (taps[n].back() < 0) throw OutputError("/dev/net/tun", "is not allowed here", kRemedy);
      set_up(i, "ip address add " + address(i, n) + "/24 dev " + device(n) + " && ip link set " +
                    device(n) + " txqueuelen 10000 up");
    }
    if (networks > 0) set_up(i, "ip route add default dev " + device(0));
  }
  for (std::vector<int>& network : taps) {
    hubs_.push_back(std::make_unique<LossyHub>(std::move(network)));
  }
}

void VirtualNetwork::set_up(std::size_t host, const std::string& words) const {
  ChildProcess shell(on_host(holders_[host]->pid(), {"sh", "-c", words}));
  if (shell.wait() != 0) throw OutputError(words, "fails", "install iproute2");
}

std::unique_ptr<ChildProcess> VirtualNetwork::run(std::size_t host,
                                                  const std::vector<std::string>& command,
                                                  std::vector<std::string> environment) const {
  return std::make_unique<ChildProcess>(on_host(holders_[host]->pid(), command),
                                        std::move(environment), ChildProcess::Errors::kMerged);
}

}  // namespace strata::test
