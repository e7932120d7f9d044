// SPDX-License-Identifier: Apache-2.0
/// The ports of shared memory, which Fast DDS keeps as files that it trusts.
#pragma once

#include <cstdint>
#include <filesystem>

#include "components/bus/shared_memory.hpp"

namespace strata::bus {

/// Numbers of ports as Fast DDS counts them: base + 250 * domain + offset, and one more for each
/// participant of a host. They lie below a domain's usual ones (7400 + 250 * domain to 211 above),
/// where no process of another release of Fast DDS puts files of its own making.
struct SharedPortNumbers {
  std::uint16_t base = 7400 - 250;
  std::uint16_t discovery = 212;      ///< of the first participant
  std::uint16_t user = 230;           ///< of the first participant
  std::uint16_t all_discovery = 248;  ///< where all of them listen
  std::uint16_t all_user = 249;
};
inline constexpr SharedPortNumbers kSharedPorts;
/// So many participants of a host and domain find each other.
inline constexpr int kSharedMemoryParticipants = kSharedPorts.user - kSharedPorts.discovery;

/// Sees to it that nobody else's files lie where this domain's ports of shared memory are: Fast DDS
/// 2.9 aborts, hangs or crashes on a file of another layout, of zeros or of nothing. Held as long
/// as a participant uses them.
class SharedPortClaim {
 public:
  /// Removes what is left at these ports where no process holds a claim. Throws OutputError where
  /// another user has files there: they cannot be trusted, or a process of that user's shares
  /// memory on this domain.
  explicit SharedPortClaim(int domain, const std::filesystem::path& folder = kSharedMemoryFolder);
  ~SharedPortClaim();
  SharedPortClaim(const SharedPortClaim&) = delete;
  SharedPortClaim& operator=(const SharedPortClaim&) = delete;

 private:
  int lock_ = -1;
};

}  // namespace strata::bus
