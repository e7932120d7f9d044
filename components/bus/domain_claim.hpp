// SPDX-License-Identifier: Apache-2.0
/// One process at a time on a DDS domain of this machine, for those that must not meet each other.
#pragma once

#include <optional>
#include <string>

namespace strata::bus {

/// Held until it is destroyed or its process ends, however that happens. It keeps away only those
/// who ask for the same claim; whoever joins the domain without asking is not hindered. Claims
/// reach as far as loopback does: processes in another network namespace do not see each other and
/// may hold the same one.
class DomainClaim {
 public:
  /// purpose: as "replay"; claims with different purposes do not exclude each other. Nothing when
  /// another holds it. Throws OutputError when the system gives no socket.
  [[nodiscard]] static std::optional<DomainClaim> take(const std::string& purpose, int domain);

  DomainClaim(DomainClaim&& other) noexcept;
  DomainClaim& operator=(DomainClaim&& other) noexcept;
  DomainClaim(const DomainClaim&) = delete;
  DomainClaim& operator=(const DomainClaim&) = delete;
  ~DomainClaim();

 private:
  explicit DomainClaim(int socket) : socket_(socket) {}

  int socket_;  ///< -1: moved from
};

}  // namespace strata::bus
