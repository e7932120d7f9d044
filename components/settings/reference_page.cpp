// SPDX-License-Identifier: Apache-2.0
#include "components/settings/reference_page.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace strata::settings {

bool is_of_list(const ReferenceRow& row) {
  return row.type == detail::kList || row.key.find("[]") != std::string::npos;
}

namespace detail {
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

enum class Part { kUsers, kExperts, kLists };

/// Where a row stands; groups where one of their experts' settings is.
bool is_in(Part part, const ReferenceRow& row, const std::vector<ReferenceRow>& rows) {
  if (is_of_list(row)) return part == Part::kLists;
  if (row.type == kGroup) {
    return part == Part::kExperts && std::any_of(rows.begin(), rows.end(), [&](const auto& other) {
             return other.key.starts_with(row.key + ".") && other.type != kGroup &&
                    other.when.empty() && !is_of_list(other);
           });
  }
  return part == (row.when.empty() ? Part::kExperts : Part::kUsers);
}

/// Empty when no row stands there.
std::string table(Part part, const std::vector<ReferenceRow>& rows) {
  const bool with_when = part == Part::kUsers;
  std::string text;
  for (const ReferenceRow& row : rows) {
    if (!is_in(part, row, rows)) continue;
    text += "| " + as_code(escaped(row.key)) + " | " + escaped(row.type) + " | " +
            as_code(escaped(row.default_value)) + " | " + escaped(row.unit) + " | " +
            escaped(row.range) + " | " + escaped(row.doc) +
            (with_when ? " | " + escaped(row.when) : "") + " |\n";
  }
  if (text.empty()) return "";
  const std::string head = "| key | type | default | unit | range | meaning |";
  return head + (with_when ? " touch it when |" : "") + "\n|---|---|---|---|---|---|" +
         (with_when ? "---|" : "") + "\n" + text;
}

std::string preset_table(const std::vector<PresetLine>& lines) {
  std::map<std::string, std::string> settings;
  for (const PresetLine& line : lines) {
    std::string& text = settings[line.preset];
    text += (text.empty() ? "`" : ", `") + line.key + ": " + line.value + "`";
  }
  std::string text;
  for (const auto& [preset, sets] : settings) text += "| `" + preset + "` | " + sets + " |\n";
  return text;
}

}  // namespace

std::string range_text(const FieldInfo& info) {
  const bool has_min = std::isfinite(info.min);
  const bool has_max = std::isfinite(info.max);
  if (has_min && has_max) return yaml_text(info.min) + " to " + yaml_text(info.max);
  if (has_min) return "at least " + yaml_text(info.min);
  if (has_max) return "at most " + yaml_text(info.max);
  return "";
}

std::string markdown_of(const std::vector<ReferenceRow>& rows,
                        const std::vector<PresetLine>& presets) {
  const std::string users = table(Part::kUsers, rows);
  std::string text = "## Settings\n\n";
  text += users.empty() ? "None that a user has to touch.\n" : users;
  if (!presets.empty()) {
    text +=
        "\n## Presets\n\n`preset: NAME` sets at once what the paper's form of the algorithm "
        "is; keys beside it win. Several: `preset: [NAME, NAME]`.\n\n"
        "| preset | sets |\n|---|---|\n" +
        preset_table(presets);
  }
  if (const std::string experts = table(Part::kExperts, rows); !experts.empty()) {
    text +=
        "\n## Expert settings\n\nThe defaults are meant to stay: these are for research, and "
        "for a fault that has been understood.\n\n" +
        experts;
  }
  if (const std::string lists = table(Part::kLists, rows); !lists.empty()) {
    text += "\n## Lists\n\nWhat the items of lists hold.\n\n" + lists;
  }
  return text;
}

}  // namespace detail
}  // namespace strata::settings
