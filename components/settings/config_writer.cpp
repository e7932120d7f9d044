// SPDX-License-Identifier: Apache-2.0
#include "components/settings/config_writer.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include <yaml-cpp/yaml.h>

namespace strata::settings::detail {

std::string yaml_text(bool value) { return value ? "true" : "false"; }
std::string yaml_text(int value) { return std::to_string(value); }
std::string yaml_text(std::int64_t value) { return std::to_string(value); }
std::string yaml_text(std::uint64_t value) { return std::to_string(value); }

std::string yaml_text(double value) {
  if (std::isinf(value)) return value > 0 ? ".inf" : "-.inf";
  if (std::isnan(value)) return ".nan";
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

std::string yaml_text(const std::string& value) {
  YAML::Emitter out;
  // An empty text and one that reads as null need the quotes.
  const bool quote = value.empty() || value == "~" || value == "null" || value == "true" ||
                     value == "false" || value.find('\n') != std::string::npos;
  if (quote) out << YAML::DoubleQuoted;
  // Inside a flow list plain commas and brackets would split the text.
  out << YAML::Flow << YAML::BeginSeq;
  if (quote) out << YAML::DoubleQuoted;
  out << value << YAML::EndSeq;
  const std::string list = out.c_str();
  return list.substr(1, list.size() - 2);
}

std::string comment_of(const FieldInfo& info) {
  const std::string unit = info.unit;
  const std::string doc = info.doc;
  if (unit.empty() && doc.empty()) return "";
  return "  # " + (unit.empty() ? "" : "[" + unit + "] ") + doc;
}

}  // namespace strata::settings::detail
