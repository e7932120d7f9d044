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
constexpr int kSequenceOffset = 144;

int scalar_id(const std::string& name) {
  static const std::map<std::string, int> ids = {
      {"int8", 2},   {"uint8", 3}, {"int16", 4},  {"uint16", 5},   {"int32", 6},
      {"uint32", 7}, {"int64", 8}, {"uint64", 9}, {"float32", 10}, {"float64", 11},
      {"char", 13},  {"bool", 15}, {"byte", 16},  {"string", 17}};
  const auto found = ids.find(name);
  return found == ids.end() ? kNestedType : found->second;
}

/// "std_msgs/msg/Header" of "std_msgs/Header".
std::string full_name(const std::string& name) {
  const std::size_t slash = name.find('/');
  return name.substr(0, slash) + "/msg" + name.substr(slash);
}

/// A field's line of a .msg text: "float32[] ranges".
std::string field_json(const std::string& line) {
  const std::size_t blank = line.find(' ');
  std::string type = line.substr(0, blank);
  const std::string name = line.substr(blank + 1);
  int offset = 0;
  std::string capacity = "0";
  if (const std::size_t bracket = type.find('['); bracket != std::string::npos) {
    capacity = type.substr(bracket + 1, type.size() - bracket - 2);
    offset = capacity.empty() ? kSequenceOffset : kArrayOffset;
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

}  // namespace

std::string type_description(std::string_view type) {
  std::istringstream text(message_definition(type));
  if (text.peek() == std::istringstream::traits_type::eof()) return {};
  const std::string top(type);
  std::map<std::string, std::vector<std::string>> types;  // sorted, as the referenced ones must be
  std::string current = top;
  types[current];
  for (std::string line; std::getline(text, line);) {
    constexpr std::string_view kPart = "MSG: ";
    if (line.starts_with(kPart)) {
      current = full_name(line.substr(kPart.size()));
      types[current];
    } else if (!line.empty() && line.find('=') == std::string::npos) {
      types[current].push_back(line);
    }
  }
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
