// SPDX-License-Identifier: Apache-2.0
#include "tests/components/convert/ros_types.hpp"

#include <array>
#include <cstdio>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>

#include <openssl/sha.h>

namespace strata::test {
namespace {

/// FIELD_TYPE_* of type_description_interfaces/msg/FieldType by the names of a .msg; a char of a
/// .msg is a uint8. 1: another message.
int field_type(const std::string& type) {
  static const std::vector<std::string> in_order = {
      "",       "",        "int8",    "uint8", "int16", "uint16", "int32", "uint32", "int64",
      "uint64", "float32", "float64", "",      "",      "",       "bool",  "byte",   "string"};
  if (type == "char") return 3;
  for (std::size_t i = 2; i < in_order.size(); ++i) {
    if (in_order[i] == type) return static_cast<int>(i);
  }
  return 1;
}

std::string package_of(const std::string& name) { return name.substr(0, name.find('/')); }

/// "geometry_msgs/Pose" and "Pose" are geometry_msgs/msg/Pose.
std::string resolved(const std::string& type, const std::string& in) {
  const std::size_t slash = type.find('/');
  if (slash == std::string::npos) return package_of(in) + "/msg/" + type;
  if (type.find('/', slash + 1) != std::string::npos) return type;
  return type.substr(0, slash) + "/msg/" + type.substr(slash + 1);
}

std::string quoted(const std::string& text) { return '"' + text + '"'; }

std::string described_field(const RosTypes::Field& field, const std::string& in) {
  int id = field_type(field.type);
  const std::string nested = id == 1 ? resolved(field.type, in) : "";
  std::string capacity = "0";
  if (field.array.empty()) {
    id += 144;
  } else if (field.array.starts_with("<=")) {
    id += 96;
    capacity = field.array.substr(2);
  } else if (field.array != "-") {
    id += 48;
    capacity = field.array;
  }
  std::ostringstream json;
  json << "{\"name\": " << quoted(field.name) << ", \"type\": {\"type_id\": " << id
       << ", \"capacity\": " << capacity
       << ", \"string_capacity\": 0, \"nested_type_name\": " << quoted(nested) << "}}";
  return json.str();
}

}  // namespace

void RosTypes::add(const std::string& name, const std::string& text) {
  const bool is_part =
      name.ends_with("_Request") || name.ends_with("_Response") || name.ends_with("_Event");
  if (name.find("/srv/") != std::string::npos && !is_part) {
    const std::size_t between = text.find("---\n");
    if (between == std::string::npos) throw std::runtime_error(name + " has no ---");
    add(name + "_Request", text.substr(0, between));
    add(name + "_Response", text.substr(between + 4));
    add("service_msgs/msg/ServiceEventInfo",
        "uint8 event_type\nbuiltin_interfaces/Time stamp\nuint8[16] client_gid\n"
        "int64 sequence_number\n");
    add(name + "_Event", "service_msgs/ServiceEventInfo info\n" + name + "_Request[<=1] request\n" +
                             name + "_Response[<=1] response\n");
    messages_[name].fields = {{name + "_Request", "request_message", "-"},
                              {name + "_Response", "response_message", "-"},
                              {name + "_Event", "event_message", "-"}};
    return;
  }
  static const std::regex kConstant(R"((\w+)\s+([A-Z]\w*)\s*=\s*(\S+))");
  static const std::regex kField(R"(([\w/]+)(\[(<=\d+|\d*)\])?\s+(\w+))");
  Message& message = messages_[name];
  message = {};
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (const std::size_t comment = line.find('#'); comment != std::string::npos) {
      message.comments.push_back(line.substr(comment + 1));
      line.resize(comment);
    }
    line = std::regex_replace(line, std::regex(R"(^\s+|\s+$)"), "");
    if (line.empty()) continue;
    std::smatch match;
    if (std::regex_match(line, match, kConstant)) {
      message.constants.push_back({match[1], match[2], match[3]});
    } else if (std::regex_match(line, match, kField)) {
      message.fields.push_back({match[1], match[4], match[2].matched ? match[3].str() : "-"});
    } else {
      throw std::runtime_error(name + ": what is '" + line + "'?");
    }
  }
  // As IDL has no empty structs, rosidl fills them.
  if (message.fields.empty()) {
    message.fields = {{"uint8", "structure_needs_at_least_one_member", "-"}};
  }
}

std::string RosTypes::described(const std::string& name) const {
  std::string json = "{\"type_name\": " + quoted(name) + ", \"fields\": [";
  std::string comma;
  for (const Field& field : messages_.at(name).fields) {
    json += comma + described_field(field, name);
    comma = ", ";
  }
  return json + "]}";
}

std::string RosTypes::hash(const std::string& name) const {
  std::set<std::string> met;
  std::vector<std::string> open = {name};
  while (!open.empty()) {
    const std::string type = open.back();
    open.pop_back();
    for (const Field& field : messages_.at(type).fields) {
      if (field_type(field.type) != 1) continue;
      if (met.insert(resolved(field.type, type)).second)
        open.push_back(*met.find(resolved(field.type, type)));
    }
  }
  std::string json =
      "{\"type_description\": " + described(name) + ", \"referenced_type_descriptions\": [";
  std::string comma;
  for (const std::string& type : met) {
    json += comma + described(type);
    comma = ", ";
  }
  json += "]}";
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
  SHA256(reinterpret_cast<const unsigned char*>(json.data()), json.size(), digest.data());
  std::string text = "RIHS01_";
  for (const unsigned char byte : digest) {
    std::array<char, 3> hex{};
    std::snprintf(hex.data(), hex.size(), "%02x", byte);
    text += hex.data();
  }
  return text;
}

}  // namespace strata::test
