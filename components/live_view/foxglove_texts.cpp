// SPDX-License-Identifier: Apache-2.0
#include "components/live_view/foxglove_texts.hpp"

#include <chrono>
#include <string_view>

#include <nlohmann/json.hpp>

namespace strata::live_view {
namespace {

using Json = nlohmann::json;

/// Names that others gave may be no UTF-8.
std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

template <typename T>
void append(std::vector<std::uint8_t>& bytes, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
}

}  // namespace

std::string server_info(const std::string& name, const CommandNames& commands) {
  Json capabilities = Json::array();
  if (!commands.initial_pose_topic.empty()) capabilities.push_back("clientPublish");
  if (!commands.relocalize_service.empty()) capabilities.push_back("services");
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

std::string advertised_service(const std::string& relocalize_service) {
  const auto part = [](const char* name) {
    return Json{
        {"encoding", "cdr"}, {"schemaName", name}, {"schemaEncoding", "ros2msg"}, {"schema", ""}};
  };
  return text_of(
      {{"op", "advertiseServices"},
       {"services", Json::array({{{"id", kRelocalizeService},
                                  {"name", relocalize_service},
                                  {"type", "std_srvs/srv/Empty"},
                                  {"request", part("std_srvs/srv/Empty_Request")},
                                  {"response", part("std_srvs/srv/Empty_Response")}}})}});
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

std::vector<std::uint8_t> empty_response(std::uint32_t service, std::uint32_t call) {
  constexpr std::string_view kEncoding = "cdr";
  std::vector<std::uint8_t> bytes;
  append(bytes, static_cast<std::uint8_t>(ServerOpcode::kServiceResponse));
  append(bytes, service);
  append(bytes, call);
  append(bytes, static_cast<std::uint32_t>(kEncoding.size()));
  bytes.insert(bytes.end(), kEncoding.begin(), kEncoding.end());
  // Little-endian CDR; a message without members has one byte.
  bytes.insert(bytes.end(), {0, 1, 0, 0, 0});
  return bytes;
}

}  // namespace strata::live_view
