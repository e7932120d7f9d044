// SPDX-License-Identifier: Apache-2.0
#include "tools/expect/compare_results.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <limits>
#include <system_error>
#include <tuple>
#include <utility>

#include <fnmatch.h>

#include "components/settings/settings.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::expect {
namespace {

using log::FieldValue;

bool matches(const std::string& pattern, const std::string& text) {
  return fnmatch(pattern.c_str(), text.c_str(), 0) == 0;
}

std::string shown(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.10g", value);
  return buffer;
}
std::string shown(const FieldValue& value) {
  return value.is_text ? "'" + value.text + "'" : shown(value.number);
}

/// What is allowed for one value.
struct Allowed {
  bool ignored = false;
  double absolute = 0.0;
  double relative = 0.0;
};

Allowed allowed_for(const std::string& name, const std::string& field,
                    const Tolerances& tolerances) {
  const std::string whole = name + ":" + field;
  for (const std::string& pattern : tolerances.ignore) {
    if (matches(pattern, whole)) return {true, 0.0, 0.0};
  }
  Allowed allowed{false, tolerances.absolute, tolerances.relative};
  for (const ToleranceRule& rule : tolerances.rules) {
    if (matches(rule.match, whole)) allowed = {false, rule.absolute, rule.relative};
  }
  return allowed;
}

bool same(const FieldValue& a, const FieldValue& b) {
  if (a.is_text != b.is_text) return false;
  if (a.is_text) return a.text == b.text;
  return a.number == b.number || (std::isnan(a.number) && std::isnan(b.number));
}

/// The difference in radians, for angles that may have come out a turn apart.
double distance(const std::string& field, double a, double b) {
  const bool is_angle = field.ends_with("theta") || field.ends_with("yaw");
  return std::abs(is_angle ? std::remainder(a - b, 2.0 * M_PI) : a - b);
}

/// What is wrong with one value; nothing when it is as allowed.
std::optional<std::string> fault(const FieldValue& got, const FieldValue& expected,
                                 const std::string& name, const std::string& field,
                                 const Tolerances& tolerances) {
  const Allowed allowed = allowed_for(name, field, tolerances);
  if (allowed.ignored) return std::nullopt;
  double tolerance = 0.0;
  if (!got.is_text && !expected.is_text) {
    tolerance = allowed.absolute + allowed.relative * std::abs(expected.number);
    if (distance(field, got.number, expected.number) <= tolerance) return std::nullopt;
  }
  return "is " + shown(got) + ", expected " + shown(expected) +
         (tolerance > 0.0 ? " (tolerance " + shown(tolerance) + ")" : "");
}

std::vector<FieldValue> values_of(const Entry& entry) {
  if (entry.type.empty()) return entry.values;
  return log::message_fields(entry.type, entry.bytes).value_or(std::vector<FieldValue>{});
}
std::string name_of(const Entry& entry, std::size_t index) {
  if (!entry.type.empty()) return log::field_path(entry.type, entry.bytes, index);
  return entry.name_of ? entry.name_of(index) : std::string();
}

using Found = std::optional<std::pair<std::string, std::string>>;  // field, problem

/// The first value of an entry that differs by more than allowed.
Found compare(const Entry& got, const Entry& expected, const std::string& name,
              const Tolerances& tolerances) {
  if (got.stamp != expected.stamp) {
    const double difference_s = got.stamp && expected.stamp
                                    ? (*got.stamp - *expected.stamp).seconds()
                                    : std::numeric_limits<double>::quiet_NaN();
    return std::pair(std::string("time"), "is " + shown(difference_s) + " s from the expected");
  }
  if (!expected.type.empty() && got.bytes == expected.bytes) return std::nullopt;
  const std::vector<FieldValue> ours = values_of(got);
  const std::vector<FieldValue> theirs = values_of(expected);
  if (!expected.type.empty() && theirs.empty()) {
    if (allowed_for(name, "bytes", tolerances).ignored) return std::nullopt;
    return std::pair(std::string("bytes"),
                     "differ, and fields of " + expected.type + " are not known");
  }
  for (std::size_t i = 0; i < std::min(ours.size(), theirs.size()); ++i) {
    if (same(ours[i], theirs[i])) continue;
    const std::string field = name_of(expected, i);
    if (const std::string other = name_of(got, i); other != field) {
      return std::pair(field, "is not there; " + other + " is");
    }
    if (auto problem = fault(ours[i], theirs[i], name, field, tolerances)) {
      return std::pair(field, *problem);
    }
  }
  if (ours.size() != theirs.size()) {
    return std::pair(std::string("size"), "is " + std::to_string(ours.size()) +
                                              " values, expected " + std::to_string(theirs.size()));
  }
  return std::nullopt;
}

/// Messages of one stamp in an order of their own.
void sort_messages(Series& series) {
  std::stable_sort(series.entries.begin(), series.entries.end(),
                   [](const Entry& a, const Entry& b) {
                     return !a.type.empty() && !b.type.empty() &&
                            std::tie(a.stamp, a.bytes) < std::tie(b.stamp, b.bytes);
                   });
}

std::optional<Difference> compare(const Series& got, const Series& expected,
                                  const std::string& name, const Tolerances& tolerances) {
  Difference first{name, std::nullopt, "", "", 0, expected.entries.size()};
  const std::size_t common = std::min(got.entries.size(), expected.entries.size());
  for (std::size_t i = 0; i < common; ++i) {
    const Found found = compare(got.entries[i], expected.entries[i], name, tolerances);
    if (!found) continue;
    if (first.differing++ > 0) continue;
    first.stamp = expected.entries[i].stamp;
    std::tie(first.field, first.problem) = *found;
  }
  if (got.entries.size() != expected.entries.size()) {
    if (first.differing == 0) {
      const Series& longer = got.entries.size() > common ? got : expected;
      first.stamp = longer.entries[common].stamp;
      first.field = "number of " + expected.unit + "s";
      first.problem = "is " + std::to_string(got.entries.size()) + ", expected " +
                      std::to_string(expected.entries.size());
    }
    first.differing += std::max(got.entries.size(), expected.entries.size()) - common;
  }
  if (first.differing == 0) return std::nullopt;
  return first;
}

bool is_comparable(const fs::path& path) {
  const std::string ending = path.extension().string();
  return ending == ".tum" || ending == ".csv" || ending == ".json" || ending == ".yaml" ||
         ending == ".pgm";
}

}  // namespace

std::vector<Difference> compare_results(Results expected, Results got,
                                        const Tolerances& tolerances) {
  std::vector<Difference> differences;
  for (auto& [name, series] : expected) {
    const auto found = got.find(name);
    if (found == got.end()) {
      differences.push_back({name, std::nullopt, "", "is missing", 0, series.entries.size()});
      continue;
    }
    sort_messages(series);
    sort_messages(found->second);
    if (auto difference = compare(found->second, series, name, tolerances)) {
      differences.push_back(std::move(*difference));
    }
  }
  std::stable_sort(differences.begin(), differences.end(),
                   [](const Difference& a, const Difference& b) {
                     if (a.stamp && b.stamp) return *a.stamp < *b.stamp;
                     return a.stamp.has_value() && !b.stamp.has_value();
                   });
  return differences;
}

std::string describe(const Difference& difference) {
  std::string text = difference.name;
  if (difference.stamp) {
    char time[40];
    std::snprintf(time, sizeof time, " at %.9f s", difference.stamp->seconds());
    text += time;
  }
  text += ": " + (difference.field.empty() ? "" : difference.field + " ") + difference.problem;
  if (difference.entries > 1) {
    text += "; " + std::to_string(difference.differing) + " of " +
            std::to_string(difference.entries) + " differ";
  }
  return text;
}

Tolerances load_tolerances(const fs::path& folder) {
  const fs::path file = folder / kTolerancesFile;
  if (!fs::exists(file)) return {};
  return settings::read_config<Tolerances>(settings::load_document(file), file.string());
}

void accept_results(const fs::path& results, const fs::path& expected) {
  const fs::path tolerances = expected / kTolerancesFile;
  std::string kept;
  if (fs::exists(expected) && !fs::is_empty(expected) && !fs::exists(tolerances)) {
    throw OutputError(expected.string(), "holds other things than expected results",
                      std::string("choose another folder, or put a ") + kTolerancesFile +
                          " into it if all of it may be replaced");
  }
  if (fs::exists(tolerances)) {
    std::ifstream in(tolerances, std::ios::binary);
    kept.assign(std::istreambuf_iterator<char>(in), {});
  } else {
    kept = settings::write_yaml(Tolerances{}, {.with_version = true, .with_comments = true});
  }
  try {
    fs::remove_all(expected);
    fs::create_directories(expected);
    for (auto it = fs::recursive_directory_iterator(results); it != fs::end(it); ++it) {
      const fs::path to = expected / it->path().lexically_relative(results);
      if (it->is_directory() && it->path().filename() == kTopicsFolder) {
        fs::create_directories(to.parent_path());
        fs::copy(it->path(), to, fs::copy_options::recursive);
        it.disable_recursion_pending();
      } else if (it->is_regular_file() && is_comparable(it->path())) {
        fs::create_directories(to.parent_path());
        fs::copy_file(it->path(), to);
      }
    }
  } catch (const fs::filesystem_error& error) {
    throw OutputError(expected.string(), "cannot be written: " + error.code().message(),
                      "mend its permissions or free some space");
  }
  std::ofstream out(tolerances, std::ios::binary);
  out << kept;
  out.close();
  if (!out) {
    throw OutputError(tolerances.string(), "cannot be written", "free some space");
  }
}

}  // namespace strata::expect
