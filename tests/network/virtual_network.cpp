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

constexpr const char* kDevice = "eth0";
constexpr const char* kRemedy = "run as root where namespaces and TAP devices are allowed";

/// A TAP device inside the network of that process; -1 when that is not allowed.
int make_tap(pid_t process) {
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
    std::strncpy(request.ifr_name, kDevice, IFNAMSIZ - 1);
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

std::string VirtualNetwork::address(std::size_t host) {
  return "10.77.0." + std::to_string(host + 1);
}

VirtualNetwork::VirtualNetwork(std::size_t hosts) {
  std::vector<int> taps;
  for (std::size_t i = 0; i < hosts; ++i) {
    // `cat` ends when we do. Hosts do not share memory, so each has its own /dev/shm.
    holders_.push_back(std::make_unique<ChildProcess>(
        std::vector<std::string>{"unshare", "--net", "--mount", "sh", "-c",
                                 "mount -t tmpfs tmpfs /dev/shm && echo ready && exec cat"}));
    if (holders_.back()->wait_for_line("ready").empty()) {
      throw OutputError("namespaces", "are not allowed here", kRemedy);
    }
    const pid_t process = holders_.back()->pid();
    taps.push_back(make_tap(process));
    if (taps.back() < 0) throw OutputError("/dev/net/tun", "is not allowed here", kRemedy);
    const std::string setup = "ip link set lo up && ip address add " + address(i) + "/24 dev " +
                              kDevice + " && ip link set " + kDevice +
                              " txqueuelen 10000 up && ip route add default dev " + kDevice;
    ChildProcess ip(on_host(process, {"sh", "-c", setup}));
    if (ip.wait() != 0) throw OutputError("ip", "does not set a network up", "install iproute2");
  }
  hub_ = std::make_unique<LossyHub>(std::move(taps));
}

std::unique_ptr<ChildProcess> VirtualNetwork::run(std::size_t host,
                                                  const std::vector<std::string>& command,
                                                  std::vector<std::string> environment) const {
  return std::make_unique<ChildProcess>(on_host(holders_[host]->pid(), command),
                                        std::move(environment), ChildProcess::Errors::kMerged);
}

}  // namespace strata::test
