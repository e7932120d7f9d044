// SPDX-License-Identifier: Apache-2.0
#include "components/settings/config_reader.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "core/base/error.hpp"

namespace strata::settings::detail {
namespace {

/// A scalar's text as a message shows it; long ones are cut.
std::string shown(const YAML::Node& node) {
  if (node.IsSequence()) return "is a list";
  if (node.IsMap()) return "is a group of keys";
  if (!node.IsScalar()) return "has no value";
  std::string text = node.Scalar();
  if (text.size() > 40) text = text.substr(0, 40) + "...";
  return "is '" + text + "'";
}

[[noreturn]] void refuse(const YAML::Node& node, const std::string& place, const std::string& path,
                         const std::string& expected) {
  throw ConfigError(place_of(node, place, path), path + " " + shown(node) + ", not " + expected,
                    "write " + expected);
}

template <typename Number>
std::optional<Number> parse_number(const std::string& text) {
  Number value{};
  const char* begin = text.data();
  const char* const end = begin + text.size();
  if (end - begin > 1 && *begin == '+' && begin[1] != '-') ++begin;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

template <typename Integer>
void read_integer(const YAML::Node& node, const std::string& place, const std::string& path,
                  Integer& value) {
  if (!node.IsScalar()) refuse(node, place, path, "a whole number");
  const auto parsed = parse_number<Integer>(node.Scalar());
  if (!parsed) {
    refuse(node, place, path,
           "a whole number from " + std::to_string(std::numeric_limits<Integer>::min()) + " to " +
               std::to_string(std::numeric_limits<Integer>::max()));
  }
  value = *parsed;
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before;  // the row above the row above
  std::vector<std::size_t> above(b.size() + 1);
  std::iota(above.begin(), above.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::vector<std::size_t> row = {i + 1};
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = above[j] + (a[i] == b[j] ? 0 : 1);
      row.push_back(std::min({substituted, row[j] + 1, above[j + 1] + 1}));
      const bool is_swapped = i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j];
      if (is_swapped) row.back() = std::min(row.back(), before[j - 1] + 1);
    }
    before = std::exchange(above, std::move(row));
  }
  return above.back();
}

namespace {

/// The name that `text` was meant to be; null when none is near.
const std::string* nearest(const std::string& text, const std::vector<std::string>& names) {
  const std::string* best = nullptr;
  std::size_t best_distance = std::max<std::size_t>(2, text.size() / 3) + 1;
  for (const std::string& name : names) {
    const bool is_start = text.size() >= 3 && name.starts_with(text);
    const std::size_t distance = is_start ? 1 : edit_distance(text, name);
    if (distance < best_distance) {
      best_distance = distance;
      best = &name;
    }
  }
  return best;
}

std::string listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

}  // namespace

std::string suggestion(const std::string& text, const std::vector<std::string>& names,
                       const std::string& kind) {
  const std::string* best = nearest(text, names);
  if (best != nullptr) return "did you mean '" + *best + "'?";
  return "known " + kind + " are: " + listed(names);
}

std::string key_suggestion(const std::string& text, const KeyTree& known) {
  std::vector<std::string> all;
  std::vector<std::string> of_users;
  std::vector<std::string> of_experts;
  for (const KeyTree::Key& key : known.keys) {
    all.push_back(key.name);
    (key.is_for_users() ? of_users : of_experts).push_back(key.name);
  }
  if (of_users.empty() || of_experts.empty() || nearest(text, all) != nullptr) {
    return suggestion(text, all, "keys");
  }
  return "known keys are: " + listed(of_users) + "; and for experts: " + listed(of_experts);
}

void read_value(const YAML::Node& node, const std::string& place, const std::string& path,
                bool& value) {
  if (!node.IsScalar() || (node.Scalar() != "true" && node.Scalar() != "false")) {
    refuse(node, place, path, "true or false");
  }
  value = node.Scalar() == "true";
}

void read_value(const YAML::Node& node, const std::string& place, const std::string& path,
                int& value) {
  read_integer(node, place, path, value);
}
void read_value(const YAML::Node& node, const std::string& place, const std::string& path,
                std::int64_t& value) {
  read_integer(node, place, path, value);
}
void read_value(const YAML::Node& node, const std::string& place, const std::string& path,
                std::uint64_t& value) {
  read_integer(node, place, path, value);
}

void read_value(const YAML::Node& node, const std::string& place, const std::string& path,
                double& value) {
  if (!node.IsScalar()) refuse(node, place, path, "a number");
  const std::string& text = node.Scalar();
  if (text == ".inf" || text == "+.inf" || text == "-.inf") {
    value = (text.front() == '-' ? -1.0 : 1.0) * std::numeric_limits<double>::infinity();
    return;
  }
  const auto parsed = parse_number<double>(text);
  // from_chars also takes "inf" and "nan", which YAML spells otherwise and no field wants.
  const bool has_digit = text.find_first_of("0123456789") != std::string::npos;
  if (!parsed || !has_digit) refuse(node, place, path, "a number");
  value = *parsed;
}

void read_value(const YAML::Node& node, const std::string& place, const std::string& path,
                std::string& value) {
  if (!node.IsScalar()) refuse(node, place, path, "text");
  value = node.Scalar();
}

std::size_t read_choice(const YAML::Node& node, const std::string& place, const std::string& path,
                        const std::vector<std::string>& names) {
  if (node.IsScalar()) {
    const auto found = std::find(names.begin(), names.end(), node.Scalar());
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  }
  throw ConfigError(place_of(node, place, path), path + " " + shown(node) + ", which is no choice",
                    suggestion(node.IsScalar() ? node.Scalar() : "", names, "choices"));
}

void require_sequence(const YAML::Node& node, const std::string& place, const std::string& path) {
  if (!node.IsSequence()) refuse(node, place, path, "a list");
}

void check_keys(const YAML::Node& node, const ReadContext& context, const std::string& path,
                const KeyTree& known) {
  if (!node.IsDefined() || node.IsNull()) return;
  if (!node.IsMap()) {
    throw ConfigError(place_of(node, context.place, path),
                      (path.empty() ? "this" : path) + " " + shown(node) + ", not a group of keys",
                      "write 'key: value' lines below it");
  }
  std::set<std::string> seen;
  for (const auto& item : node) {
    if (!item.first.IsScalar()) {
      throw ConfigError(place_of(item.first, context.place, path),
                        "a key of " + (path.empty() ? "this document" : path) + " is not text",
                        "use plain keys");
    }
    const std::string& key = item.first.Scalar();
    const std::string full = strata::detail::join_path(path, key);
    // A key that --set made has no line of its own; its value neither.
    const std::string place = place_of(item.first, context.place, full);
    if (known.find(key) == nullptr) {
      throw ConfigError(place, full + " is an unknown key", key_suggestion(key, known));
    }
    if (!seen.insert(key).second) {
      throw ConfigError(place, full + " is given twice", "remove one of the two");
    }
  }
}

void throw_problems_with_places(const Problems& problems, const ReadContext& context) {
  const auto place_of_problem = [&](const Problem& problem) {
    // The key itself when the document has it, else the nearest group around it.
    std::string path = problem.path;
    while (true) {
      const auto found = context.place_of_key.find(path);
      if (found != context.place_of_key.end()) return found->second;
      if (path.empty()) return context.place;
      const std::size_t cut = path.find_last_of(".[");
      path = cut == std::string::npos ? "" : path.substr(0, cut);
    }
  };
  const std::string first_place = place_of_problem(problems.front());
  std::string what;
  std::string remedy;
  std::set<std::string> told;
  for (const Problem& problem : problems) {
    // A value out of its range often breaks a requirement too, which says no more.
    if (!told.insert(problem.path).second) continue;
    const std::string place = place_of_problem(problem);
    if (!what.empty()) what += ", and ";
    if (place != first_place) what += "at " + place + " ";
    what += problem.path + " " + problem.what;
    if (remedy.find(problem.remedy) != std::string::npos) continue;
    remedy += (remedy.empty() ? "" : ", and ") + problem.remedy;
  }
  throw ConfigError(first_place, what, remedy);
}

}  // namespace strata::settings::detail
