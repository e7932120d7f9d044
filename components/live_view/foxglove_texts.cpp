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
  if (!advertised_services(commands).empty()) capabilities.push_back("services");
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

std::string advertised_services(const CommandNames& commands) {
  Json services = Json::array();
  const auto add = [&](std::uint32_t id, const std::string& name, const std::string& type,
                       const char* response) {
    if (name.empty()) return;
    const auto part = [](const std::string& schema_name, const char* schema) {
      return Json{{"encoding", "cdr"},
                  {"schemaName", schema_name},
                  {"schemaEncoding", "ros2msg"},
                  {"schema", schema}};
    };
    services.push_back({{"id", id},
                        {"name", name},
                        {"type", type},
                        {"request", part(type + "_Request", "")},
                        {"response", part(type + "_Response", response)}});
  };
  add(kRelocalizeService, commands.relocalize_service, "std_srvs/srv/Empty", "");
  add(kSaveService, commands.save_service, "std_srvs/srv/Trigger",
      "bool success\nstring message\n");
  if (services.empty()) return "";
  return text_of({{"op", "advertiseServices"}, {"services", services}});
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
