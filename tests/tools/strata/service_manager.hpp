// SPDX-License-Identifier: Apache-2.0
/// systemd's end of sd_notify(3).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace strata::test {

class ServiceManager {
 public:
  /// name: what NOTIFY_SOCKET is to say; a path, or "@" and an abstract name.
  explicit ServiceManager(const std::string& name) : socket_(socket(AF_UNIX, SOCK_DGRAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, name.data(), name.size());
    if (name.front() == '@') address.sun_path[0] = '\0';
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), size) != 0) {
      throw std::runtime_error("cannot bind " + name);
    }
  }
  ~ServiceManager() { close(socket_); }
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  /// The next message; "" when none comes in time.
  [[nodiscard]] std::string receive(std::chrono::milliseconds patience = {}) {
    pollfd waited{socket_, POLLIN, 0};
    poll(&waited, 1, static_cast<int>(patience.count()));
    char buffer[64];
    const auto got = recv(socket_, buffer, sizeof buffer, MSG_DONTWAIT);
    return got < 0 ? std::string() : std::string(buffer, static_cast<std::size_t>(got));
  }

 private:
  int socket_;
};

}  // namespace strata::test
