// SPDX-License-Identifier: Apache-2.0
/// ROS 2 message definitions for MCAP schemas, which viewers need to decode messages; made from our
/// own IDL, so that they cannot differ from what is on the wire.
#include <algorithm>
#include <cctype>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "components/log/bag_storage.hpp"
#include "components/log/idl_texts.hpp"

namespace strata::log {
namespace {

struct Definition {
  std::string text;               ///< as in a .msg file
  std::vector<std::string> uses;  ///< other messages, "std_msgs/Header"
};
using Definitions = std::map<std::string, Definition>;

/// Names with their scopes (std_msgs::msg::Header), numbers and single signs; no comments, no
/// preprocessor lines.
std::vector<std::string> tokens_of(std::string_view idl) {
  const auto in_word = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == ':';
  };
  std::vector<std::string> tokens;
  for (std::size_t at = 0; at < idl.size();) {
    if (idl[at] == '#' || idl.substr(at, 2) == "//") {
      at = std::min(idl.find('\n', at), idl.size());
    } else if (in_word(idl[at])) {
      std::size_t end = at;
      while (end < idl.size() && in_word(idl[end])) ++end;
      tokens.emplace_back(idl.substr(at, end - at));
      at = end;
    } else {
      if (std::isspace(static_cast<unsigned char>(idl[at])) == 0) tokens.emplace_back(1, idl[at]);
      ++at;
    }
  }
  return tokens;
}

/// Reads the subset of IDL that idl/ keeps to: modules, structs of scalars, strings, arrays,
/// sequences and other structs, and enums (uint32 on the wire, as DDS has them).
class IdlReader {
 public:
  IdlReader(std::string_view idl, Definitions& definitions)
      : tokens_(tokens_of(idl)), definitions_(definitions) {}

  void read() {
    while (at_ < tokens_.size()) {
      const std::string token = next();
      if (token == "module") {
        modules_.push_back(next());
        next();  // {
      } else if (token == "struct") {
        read_struct();
      } else if (token == "enum") {
        read_enum();
      } else if (token == "@") {
        next();  // the annotation
      } else if (token == "}" && !modules_.empty()) {
        modules_.pop_back();
      }
    }
  }

 private:
  std::string next() { return at_ < tokens_.size() ? tokens_[at_++] : std::string(); }
  bool skip(std::string_view token) {
    if (at_ >= tokens_.size() || tokens_[at_] != token) return false;
    ++at_;
    return true;
  }
  /// "std_msgs/Header" of std_msgs::msg::Header, or of a name in the same module.
  [[nodiscard]] std::string message_name(const std::string& idl_name) const {
    const std::size_t first = idl_name.find("::");
    if (first == std::string::npos) return modules_.front() + "/" + idl_name;
    return idl_name.substr(0, first) + "/" + idl_name.substr(idl_name.rfind("::") + 2);
  }

  void read_enum() {
    std::vector<std::string>& values = enums_[next()];
    next();  // {
    while (at_ < tokens_.size() && !skip("}")) {
      values.push_back(next());
      skip(",");
    }
  }

  std::string read_type(Definition& definition) {
    const std::string type = next();
    if (type == "sequence") {
      next();  // <
      const std::string element = read_type(definition);
      next();  // >
      return element + "[]";
    }
    static const std::map<std::string, std::string> scalars = {
        {"boolean", "bool"},   {"octet", "byte"},  {"char", "char"},     {"float", "float32"},
        {"double", "float64"}, {"int8", "int8"},   {"uint8", "uint8"},   {"int16", "int16"},
        {"uint16", "uint16"},  {"int32", "int32"}, {"uint32", "uint32"}, {"int64", "int64"},
        {"uint64", "uint64"},  {"long", "int32"},  {"string", "string"}};
    if (type == "unsigned") {
      next();  // long
      return "uint32";
    }
    if (const auto scalar = scalars.find(type); scalar != scalars.end()) return scalar->second;
    if (const auto values = enums_.find(type); values != enums_.end()) {
      for (std::size_t i = 0; i < values->second.size(); ++i) {
        definition.text += "uint32 " + values->second[i] + "=" + std::to_string(i) + "\n";
      }
      return "uint32";
    }
    definition.uses.push_back(message_name(type));
    return definition.uses.back();
  }

  void read_struct() {
    Definition& definition = definitions_[message_name(next())];
    next();  // {
    while (at_ < tokens_.size() && !skip("}")) {
      std::string type = read_type(definition);
      const std::string field = next();
      if (skip("[")) {
        type += "[" + next() + "]";
        next();  // ]
      }
      definition.text += type + " " + field + "\n";
      next();  // ;
    }
  }

  std::vector<std::string> tokens_;
  std::size_t at_ = 0;
  Definitions& definitions_;
  std::vector<std::string> modules_;
  std::map<std::string, std::vector<std::string>> enums_;
};

const Definitions& definitions() {
  static const Definitions all = [] {
    Definitions made;
    for (const std::string_view idl : idl_texts()) IdlReader(idl, made).read();
    return made;
  }();
  return all;
}

void collect(const std::string& name, std::vector<std::string>& order) {
  if (std::find(order.begin(), order.end(), name) != order.end()) return;
  order.push_back(name);
  for (const std::string& used : definitions().at(name).uses) collect(used, order);
}

}  // namespace

std::string message_definition(const std::string& type) {
  std::string name = type;
  if (const auto at = name.find("/msg/"); at != std::string::npos) name.erase(at, 4);
  if (!definitions().contains(name)) return {};
  std::vector<std::string> order;
  collect(name, order);
  std::string text = definitions().at(name).text;
  for (std::size_t i = 1; i < order.size(); ++i) {
    text += std::string(80, '=') + "\nMSG: " + order[i] + "\n" + definitions().at(order[i]).text;
  }
  return text;
}

TypeDefinition definition_of(const BagTopic& topic) {
  if (!topic.definition.empty()) return {topic.definition_encoding, topic.definition};
  return {"ros2msg", message_definition(topic.type)};
}

}  // namespace strata::log
