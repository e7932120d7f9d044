// SPDX-License-Identifier: Apache-2.0
#include "components/bus/domain_claim.hpp"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <utility>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "core/base/error.hpp"

namespace strata::bus {

// A name in the abstract namespace: no file is left behind, and the kernel frees it with the
// process.
std::optional<DomainClaim> DomainClaim::take(const std::string& purpose, int domain) {
  const std::string name = "strata-" + purpose + "-domain-" + std::to_string(domain);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::size_t length = std::min(name.size(), sizeof(address.sun_path) - 1);
  std::memcpy(address.sun_path + 1, name.data(), length);
  const int fd = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) {
    throw OutputError("domain " + std::to_string(domain),
                      std::string("cannot be claimed: ") + std::strerror(errno),
                      "check the limit of open files");
  }
  DomainClaim claim(fd);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), size) != 0) return std::nullopt;
  return claim;
}

DomainClaim::DomainClaim(DomainClaim&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)) {}

DomainClaim& DomainClaim::operator=(DomainClaim&& other) noexcept {
  std::swap(socket_, other.socket_);
  return *this;
}

DomainClaim::~DomainClaim() {
  if (socket_ >= 0) ::close(socket_);
}

}  // namespace strata::bus
