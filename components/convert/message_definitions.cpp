// SPDX-License-Identifier: Apache-2.0
#include "components/convert/message_definitions.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "components/convert/idl_texts.hpp"

namespace strata::convert {
namespace {

struct Definition {
  std::string text;               ///< as in a .msg file
  std::vector<std::string> uses;  ///< other messages, "std_msgs/Header"
  MessageLayout layout;
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
/// sequences (bounded or not) and other structs, and enums (uint32 on the wire, as DDS has them).
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
      definition.layout.fields.back().is_sequence = true;
      const std::string bound = skip(",") ? "<=" + next() : std::string();
      next();  // >
      return element + "[" + bound + "]";
    }
    struct Scalar {
      const char* name;
      std::size_t size;
    };
    static const std::map<std::string, Scalar> scalars = {
        {"boolean", {"bool", 1}},  {"octet", {"byte", 1}},     {"char", {"char", 1}},
        {"int8", {"int8", 1}},     {"uint8", {"uint8", 1}},    {"int16", {"int16", 2}},
        {"uint16", {"uint16", 2}}, {"int32", {"int32", 4}},    {"uint32", {"uint32", 4}},
        {"long", {"int32", 4}},    {"int64", {"int64", 8}},    {"uint64", {"uint64", 8}},
        {"float", {"float32", 4}}, {"double", {"float64", 8}}, {"string", {"string", 0}}};
    if (const auto scalar = scalars.find(type); scalar != scalars.end()) {
      definition.layout.fields.push_back({scalar->second.size});
      return scalar->second.name;
    }
    if (const auto values = enums_.find(type); values != enums_.end()) {
      for (std::size_t i = 0; i < values->second.size(); ++i) {
        definition.text += "uint32 " + values->second[i] + "=" + std::to_string(i) + "\n";
      }
      definition.layout.fields.push_back({4});
      return "uint32";
    }
    definition.uses.push_back(message_name(type));
    definition.layout.fields.push_back({0, &definitions_[definition.uses.back()].layout});
    return definition.uses.back();
  }

  void read_struct() {
    Definition& definition = definitions_[message_name(next())];
    next();  // {
    while (at_ < tokens_.size() && !skip("}")) {
      std::string type = read_type(definition);
      const std::string field = next();
      if (skip("[")) {
        const std::string count = next();
        definition.layout.fields.back().count = std::stoul(count);
        type += "[" + count + "]";
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

/// "std_msgs/Header" of "std_msgs/msg/Header".
std::string short_name(std::string_view type) {
  const std::size_t first = std::min(type.find('/'), type.size());
  const std::size_t last = type.rfind('/');
  return std::string(type.substr(0, first)) +
         (last == std::string_view::npos ? "" : std::string(type.substr(last)));
}

}  // namespace

std::string message_definition(std::string_view type) {
  const std::string name = short_name(type);
  if (!definitions().contains(name)) return {};
  std::vector<std::string> order;
  collect(name, order);
  std::string text = definitions().at(name).text;
  for (std::size_t i = 1; i < order.size(); ++i) {
    text += std::string(80, '=') + "\nMSG: " + order[i] + "\n" + definitions().at(order[i]).text;
  }
  return text;
}

const MessageLayout* message_layout(std::string_view type) {
  const auto found = definitions().find(short_name(type));
  return found == definitions().end() ? nullptr : &found->second.layout;
}

}  // namespace strata::convert
