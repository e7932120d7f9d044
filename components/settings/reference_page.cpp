// SPDX-License-Identifier: Apache-2.0
#include "components/settings/reference_page.hpp"

#include <cmath>

namespace strata::settings::detail {
namespace {

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '|') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result;
}

std::string as_code(const std::string& text) { return text.empty() ? "" : "`" + text + "`"; }

}  // namespace

std::string range_text(const FieldInfo& info) {
  const bool has_min = std::isfinite(info.min);
  const bool has_max = std::isfinite(info.max);
  if (has_min && has_max) return yaml_text(info.min) + " to " + yaml_text(info.max);
  if (has_min) return "at least " + yaml_text(info.min);
  if (has_max) return "at most " + yaml_text(info.max);
  return "";
}

std::string markdown_table(const std::vector<ReferenceRow>& rows) {
  std::string text =
      "| key | type | default | unit | range | meaning |\n|---|---|---|---|---|---|\n";
  for (const ReferenceRow& row : rows) {
    text += "| " + as_code(escaped(row.key)) + " | " + escaped(row.type) + " | " +
            as_code(escaped(row.default_value)) + " | " + escaped(row.unit) + " | " +
            escaped(row.range) + " | " + escaped(row.doc) + " |\n";
  }
  return text;
}

}  // namespace strata::settings::detail
