// SPDX-License-Identifier: Apache-2.0
/// The JSON messages of Foxglove's WebSocket protocol that a server sends.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "components/live_view/view_hub.hpp"

namespace strata::live_view {

/// In the order in which a server likes them; the messages are the same.
inline constexpr const char* kSubprotocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};
inline constexpr const char* kInitialPoseType = "geometry_msgs/msg/PoseWithCovarianceStamped";

/// Opcodes of binary messages.
enum class ServerOpcode : std::uint8_t { kMessage = 1, kServiceResponse = 3 };
enum class ClientOpcode : std::uint8_t { kMessage = 1, kServiceRequest = 2 };

[[nodiscard]] std::string server_info(const std::string& name, const CommandNames& commands,
                                      bool has_services);
[[nodiscard]] std::string advertised(const std::vector<Channel>& channels);
[[nodiscard]] std::string withdrawn(std::uint32_t channel);
/// Empty where there are none.
[[nodiscard]] std::string advertised_services(std::span<const ViewService> services);
[[nodiscard]] std::string status_error(const std::string& message);
[[nodiscard]] std::string service_failure(std::uint32_t service, std::uint32_t call,
                                          const std::string& message);
/// What comes before a message's CDR bytes.
[[nodiscard]] std::vector<std::uint8_t> message_head(std::uint32_t subscription,
                                                     std::uint64_t stamp_ns);
/// The whole answer of a service; cdr: its response.
[[nodiscard]] std::vector<std::uint8_t> service_response(std::uint32_t service, std::uint32_t call,
                                                         const std::vector<std::uint8_t>& cdr);

}  // namespace strata::live_view
