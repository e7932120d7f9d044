// SPDX-License-Identifier: Apache-2.0
/// What discovery has found on a domain: participants and endpoints, as they call themselves.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace strata::bus {

/// 12 bytes that name a participant, 4 that name an entity of it.
using Guid = std::array<std::uint8_t, 16>;

/// Whether two entities belong to one participant.
[[nodiscard]] inline bool same_participant(const Guid& a, const Guid& b) {
  for (std::size_t i = 0; i < 12; ++i) {
    if (a[i] != b[i]) return false;
  }
  return true;
}

/// "010f8a3c.4b2d0100.00000000.000001c1".
[[nodiscard]] std::string guid_text(const Guid& guid);

/// The two bytes that RTPS gives each maker of a DDS, in front of every GUID.
[[nodiscard]] inline std::uint16_t vendor_of(const Guid& guid) {
  return static_cast<std::uint16_t>(guid[0] << 8U | guid[1]);
}
inline constexpr std::uint16_t kVendorFastDds = 0x010F;
inline constexpr std::uint16_t kVendorCyclone = 0x0110;
/// "Fast DDS", "Cyclone DDS", ...; "vendor 01.2a" for one we do not know.
[[nodiscard]] std::string vendor_name(std::uint16_t vendor);

/// What Fast DDS puts into its GUIDs: two bytes that all processes of one host share, and the lower
/// 16 bits of the process id. Of another vendor's they say nothing.
[[nodiscard]] inline std::uint16_t host_of(const Guid& guid) {
  return static_cast<std::uint16_t>(guid[2] | guid[3] << 8U);
}
[[nodiscard]] inline std::uint16_t process_of(const Guid& guid) {
  return static_cast<std::uint16_t>(guid[4] | guid[5] << 8U);
}

struct DiscoveredParticipant {
  Guid guid{};
  std::string name;
  std::string enclave;              ///< from its user data, as ROS 2 sets it; empty: none given
  bool uses_shared_memory = false;  ///< is to be reached so, from where discovery runs
  std::vector<std::uint16_t> ports = {};  ///< where it listens, of UDP and of shared memory
};

/// With the numbers that rmw has for them.
enum class Liveliness : std::uint8_t { kAutomatic = 1, kManualByTopic = 3, kUnknown = 4 };

struct DiscoveredEndpoint {
  Guid guid{};
  bool writes = false;  ///< a writer; else a reader
  std::string wire_topic;
  std::string wire_type;
  bool reliable = false;
  bool transient_local = false;
  double deadline_s = 0.0;  ///< 0: none
  std::string type_hash;    ///< "RIHS01_...", as ROS 2 tells it since Iron; empty: not told
  double lifespan_s = 0.0;  ///< of a writer's messages; 0: none is too old
  Liveliness liveliness = Liveliness::kAutomatic;
  double lease_s = 0.0;  ///< of its liveliness; 0: without limit
};

struct DomainView {
  std::vector<DiscoveredParticipant> participants;
  std::vector<DiscoveredEndpoint> endpoints;
};

}  // namespace strata::bus
