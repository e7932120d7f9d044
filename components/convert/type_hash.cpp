// SPDX-License-Identifier: Apache-2.0
#include "components/convert/type_hash.hpp"

#include <array>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <openssl/evp.h>

#include "components/convert/message_definitions.hpp"

namespace strata::convert {
namespace {

/// Type ids of type_description_interfaces/msg/FieldType.
constexpr int kNestedType = 1;
constexpr int kArrayOffset = 48;
constexpr int kBoundedSequenceOffset = 96;
constexpr int kSequenceOffset = 144;

int scalar_id(const std::string& name) {
  static const std::map<std::string, int> ids = {
      {"int8", 2},   {"uint8", 3}, {"int16", 4},  {"uint16", 5},   {"int32", 6},
      {"uint32", 7}, {"int64", 8}, {"uint64", 9}, {"float32", 10}, {"float64", 11},
      {"char", 13},  {"bool", 15}, {"byte", 16},  {"string", 17}};
  const auto found = ids.find(name);
  return found == ids.end() ? kNestedType : found->second;
}

/// "std_msgs/msg/Header" of "std_msgs/Header"; what is full already stays.
std::string full_name(const std::string& name) {
  const std::size_t slash = name.find('/');
  if (name.rfind('/') != slash) return name;
  return name.substr(0, slash) + "/msg" + name.substr(slash);
}

/// A field's line of a .msg text: "float32[] ranges", "uint8[16] gid", "Request[<=1] request".
std::string field_json(const std::string& line) {
  const std::size_t blank = line.find(' ');
  std::string type = line.substr(0, blank);
  const std::string name = line.substr(blank + 1);
  int offset = 0;
  std::string capacity = "0";
  if (const std::size_t bracket = type.find('['); bracket != std::string::npos) {
    capacity = type.substr(bracket + 1, type.size() - bracket - 2);
    offset = capacity.empty() ? kSequenceOffset : kArrayOffset;
    if (capacity.starts_with("<=")) {
      offset = kBoundedSequenceOffset;
      capacity.erase(0, 2);
    }
    if (capacity.empty()) capacity = "0";
    type.resize(bracket);
  }
  const int id = scalar_id(type);
  return R"({"name": ")" + name + R"(", "type": {"type_id": )" + std::to_string(id + offset) +
         R"(, "capacity": )" + capacity + R"(, "string_capacity": 0, "nested_type_name": ")" +
         (id == kNestedType ? full_name(type) : "") + R"("}})";
}

/// One type of a definition: its name and the lines of its fields, constants left out.
std::string type_json(const std::string& name, const std::vector<std::string>& lines) {
  std::string json = R"({"type_name": ")" + name + R"(", "fields": [)";
  const char* comma = "";
  for (const std::string& line : lines) {
    json += comma + field_json(line);
    comma = ", ";
  }
  return json + "]}";
}

/// The lines of the fields of each type, by its full name, sorted as referenced types must be.
using Types = std::map<std::string, std::vector<std::string>>;

/// "uint8 FLOAT64=8", but not "Range[<=1] range".
bool is_constant(const std::string& line) {
  const std::size_t sign = line.find('=');
  return sign != std::string::npos && (sign == 0 || line[sign - 1] != '<');
}

/// Adds a message and all that it contains; false for one that we do not know.
bool add_message(const std::string& type, Types& types) {
  std::istringstream text(message_definition(type));
  if (text.peek() == std::istringstream::traits_type::eof()) return false;
  std::string current = type;
  types[current].clear();
  for (std::string line; std::getline(text, line);) {
    constexpr std::string_view kPart = "MSG: ";
    if (line.starts_with(kPart)) {
      current = full_name(line.substr(kPart.size()));
      types[current].clear();
    } else if (!line.empty() && !is_constant(line)) {
      types[current].push_back(line);
    }
  }
  return true;
}

/// A service is described as a type with three members: what is asked, what is answered, and the
/// event by which ROS 2 lets others watch it, though nobody need publish those.
bool add_service(const std::string& type, Types& types) {
  const std::string request = type + "_Request";
  const std::string response = type + "_Response";
  if (!add_message(request, types) || !add_message(response, types)) return false;
  if (!add_message("builtin_interfaces/msg/Time", types)) return false;
  const std::string info = "service_msgs/msg/ServiceEventInfo";
  types[info] = {"uint8 event_type", "builtin_interfaces/msg/Time stamp", "uint8[16] client_gid",
                 "int64 sequence_number"};
  types[type + "_Event"] = {info + " info", request + "[<=1] request", response + "[<=1] response"};
  types[type] = {request + " request_message", response + " response_message",
                 type + "_Event event_message"};
  return true;
}

}  // namespace

std::string type_description(std::string_view type) {
  const std::string top(type);
  Types types;
  const bool is_service = top.find("/srv/") != std::string::npos && !top.ends_with("_Request") &&
                          !top.ends_with("_Response");
  if (!(is_service ? add_service(top, types) : add_message(top, types))) return {};
  std::string json = R"({"type_description": )" + type_json(top, types.at(top)) +
                     R"(, "referenced_type_descriptions": [)";
  const char* comma = "";
  for (const auto& [name, lines] : types) {
    if (name == top) continue;
    json += comma + type_json(name, lines);
    comma = ", ";
  }
  return json + "]}";
}

std::string type_hash(std::string_view type) {
  const std::string description = type_description(type);
  if (description.empty()) return {};
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (EVP_Digest(description.data(), description.size(), digest.data(), &size, EVP_sha256(),
                 nullptr) != 1) {
    throw std::runtime_error("OpenSSL has no SHA-256");
  }
  constexpr const char* kDigits = "0123456789abcdef";
  std::string hash = "RIHS01_";
  for (unsigned int i = 0; i < size; ++i) {
    hash += kDigits[digest[i] >> 4U];
    hash += kDigits[digest[i] & 15U];
  }
  return hash;
}

}  // namespace strata::convert
