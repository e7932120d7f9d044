// SPDX-License-Identifier: Apache-2.0
#include "components/live_view/foxglove_texts.hpp"

#include <chrono>
#include <string_view>

#include <nlohmann/json.hpp>

#include "components/convert/message_definitions.hpp"

namespace strata::live_view {
namespace {

using Json = nlohmann::json;

/// Names that others gave may be no UTF-8.
std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Without the member that rosidl itself puts into an empty struct.
std::string schema_of(const std::string& type) {
  const std::string text = convert::message_definition(type);
  return text.starts_with("uint8 structure_needs_at_least_one_member") ? "" : text;
}

template <typename T>
void append(std::vector<std::uint8_t>& bytes, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
}

}  // namespace

std::string server_info(const std::string& name, const CommandNames& commands, bool has_services) {
  Json capabilities = Json::array();
  if (!commands.initial_pose_topic.empty()) capabilities.push_back("clientPublish");
  if (has_services) capabilities.push_back("services");
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return text_of({{"op", "serverInfo"},
                  {"name", name},
                  {"capabilities", capabilities},
                  {"supportedEncodings", {"cdr"}},
                  {"metadata", {{"initialPoseTopic", commands.initial_pose_topic}}},
                  {"sessionId", std::to_string(now.count())}});
}

std::string advertised(const std::vector<Channel>& channels) {
  Json list = Json::array();
  for (const Channel& channel : channels) {
    list.push_back({{"id", channel.id},
                    {"topic", channel.topic},
                    {"encoding", "cdr"},
                    {"schemaName", channel.type},
                    {"schema", channel.schema},
                    {"schemaEncoding", "ros2msg"}});
  }
  return text_of({{"op", "advertise"}, {"channels", list}});
}

std::string withdrawn(std::uint32_t channel) {
  return text_of({{"op", "unadvertise"}, {"channelIds", Json::array({channel})}});
}

std::string advertised_services(std::span<const ViewService> services) {
  Json list = Json::array();
  for (const ViewService& service : services) {
    const auto part = [&](const char* which) {
      const std::string type = service.type + which;
      return Json{{"encoding", "cdr"},
                  {"schemaName", type},
                  {"schemaEncoding", "ros2msg"},
                  {"schema", schema_of(type)}};
    };
    list.push_back({{"id", service.id},
                    {"name", service.name},
                    {"type", service.type},
                    {"request", part("_Request")},
                    {"response", part("_Response")}});
  }
  if (list.empty()) return "";
  return text_of({{"op", "advertiseServices"}, {"services", list}});
}

std::string status_error(const std::string& message) {
  constexpr int kErrorLevel = 2;
  return text_of({{"op", "status"}, {"level", kErrorLevel}, {"message", message}});
}

std::string service_failure(std::uint32_t service, std::uint32_t call, const std::string& message) {
  return text_of({{"op", "serviceCallFailure"},
                  {"serviceId", service},
                  {"callId", call},
                  {"message", message}});
}

std::vector<std::uint8_t> message_head(std::uint32_t subscription, std::uint64_t stamp_ns) {
  std::vector<std::uint8_t> head;
  append(head, static_cast<std::uint8_t>(ServerOpcode::kMessage));
  append(head, subscription);
  append(head, stamp_ns);
  return head;
}

std::vector<std::uint8_t> service_response(std::uint32_t service, std::uint32_t call,
                                           const std::vector<std::uint8_t>& cdr) {
  constexpr std::string_view kEncoding = "cdr";
  std::vector<std::uint8_t> bytes;
  append(bytes, static_cast<std::uint8_t>(ServerOpcode::kServiceResponse));
  append(bytes, service);
  append(bytes, call);
  append(bytes, static_cast<std::uint32_t>(kEncoding.size()));
  bytes.insert(bytes.end(), kEncoding.begin(), kEncoding.end());
  bytes.insert(bytes.end(), cdr.begin(), cdr.end());
  return bytes;
}

}  // namespace strata::live_view
