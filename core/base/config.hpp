// SPDX-License-Identifier: Apache-2.0
/// Configuration as plain aggregates that describe themselves once.
///
/// A config struct has default member initializers and one static template
///
///     struct MotionConfig {
///       double floor_m = 0.005;
///       BeamConfig beam;
///       template <class Self, class V> static void describe(Self& c, V& v) {
///         v.field("floor_m", c.floor_m, {.doc = "least noise per step", .unit = "m", .min = 0.0});
///         v.group("beam", c.beam, "one beam's mixture");
///         v.require(c.a + c.b <= 1.0, "a", "a and b sum to more than 1", "lower one of them");
///       }
///     };
///
/// from which validation (here), YAML reading and writing, and the reference pages (in
/// components/settings) all follow, so that they cannot drift apart. Field types: bool, int,
/// std::int64_t, std::uint64_t, double, std::string, std::vector of double, int or std::string, and
/// enums that have an EnumNames. `list` holds a vector of described structs.
///
/// What files may still say, for one version, with a note that tells the user:
///
///         v.renamed("least_m", "floor_m");         // a field, group or list of this struct
///         v.removed("slack_m", "floor_m says it");  // why, or what to set instead
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/error.hpp"

namespace strata {

/// One thing wrong with a configuration.
struct Problem {
  std::string path;    ///< dotted key path, e.g. "localizer.motion.floor_m"
  std::string what;    ///< e.g. "is -1, below the least value 0"
  std::string remedy;  ///< e.g. "choose a value of at least 0"
};
using Problems = std::vector<Problem>;

/// What a field is under a preset, such as {"paper-em", "false"}; value: as YAML.
struct PresetValue {
  const char* preset = "";
  const char* value = "";
};

/// What a field says of itself. min and max are inclusive and hold for each element of a vector.
struct FieldInfo {
  const char* doc = "";
  const char* unit = "";
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  const char* when = "";    ///< when a user touches it; empty: an expert setting
  PresetValue preset = {};  ///< what the preset makes of it that has another value for it
};

/// A key that files may still have: it has another name now, or none.
struct OldKey {
  std::string name;
  std::string new_name;  ///< empty: the key is gone
  std::string reason;    ///< of one that is gone: why, or what to set instead
};

/// Specialize with `static constexpr std::array<std::pair<E, const char*>, N> values` to make E a
/// field type; the names are what YAML and the reference pages show.
template <typename E>
struct EnumNames;

/// The name of an enum value; "?" when EnumNames lacks it.
template <typename E>
[[nodiscard]] constexpr const char* enum_name(E value) {
  for (const auto& [candidate, name] : EnumNames<E>::values) {
    if (candidate == value) return name;
  }
  return "?";
}

/// Every problem with the ranges, requirements and groups of a config struct.
template <typename Config>
[[nodiscard]] Problems validate(const Config& config, std::string path = "");

/// Throws ConfigError that lists every problem, when there is one.
template <typename Config>
void require_valid(const Config& config, const std::string& place);

namespace detail {

[[nodiscard]] std::string join_path(const std::string& path, std::string_view name);
void check_range(double value, const FieldInfo& info, const std::string& path, Problems& problems);
[[noreturn]] void throw_problems(const Problems& problems, const std::string& place);

/// What a visitor may leave out.
struct VisitorBase {
  void require(bool /*holds*/, std::string_view /*name*/, std::string_view /*what*/,
               std::string_view /*remedy*/) {}
  void renamed(std::string_view /*old_name*/, std::string_view /*new_name*/) {}
  void removed(std::string_view /*old_name*/, std::string_view /*reason*/) {}
};

/// The visitor behind `old_keys`.
class OldKeyCollector : public VisitorBase {
 public:
  template <typename T>
  void field(std::string_view /*name*/, const T& /*value*/, const FieldInfo& /*info*/) {}
  template <typename Group>
  void group(std::string_view /*name*/, const Group& /*group*/, const char* /*doc*/) {}
  template <typename Item>
  void list(std::string_view /*name*/, const std::vector<Item>& /*items*/, const char* /*doc*/) {}
  void renamed(std::string_view old_name, std::string_view new_name) {
    keys_.push_back({std::string(old_name), std::string(new_name), ""});
  }
  void removed(std::string_view old_name, std::string_view reason) {
    keys_.push_back({std::string(old_name), "", std::string(reason)});
  }
  [[nodiscard]] std::vector<OldKey> take() && { return std::move(keys_); }

 private:
  std::vector<OldKey> keys_;
};

/// The visitor behind `validate`.
class Validator : public VisitorBase {
 public:
  explicit Validator(std::string path) : path_(std::move(path)) {}

  template <typename T>
  void field(std::string_view name, const T& value, const FieldInfo& info) {
    if constexpr (std::is_arithmetic_v<T>) {
      check_range(static_cast<double>(value), info, join_path(path_, name), problems_);
    } else if constexpr (std::is_same_v<T, std::vector<double>> ||
                         std::is_same_v<T, std::vector<int>>) {
      for (std::size_t i = 0; i < value.size(); ++i) {
        check_range(static_cast<double>(value[i]), info,
                    join_path(path_, name) + "[" + std::to_string(i) + "]", problems_);
      }
    }
  }
  template <typename Group>
  void group(std::string_view name, const Group& group, const char* /*doc*/) {
    append(validate(group, join_path(path_, name)));
  }
  template <typename Item>
  void list(std::string_view name, const std::vector<Item>& items, const char* /*doc*/) {
    for (std::size_t i = 0; i < items.size(); ++i) {
      append(validate(items[i], join_path(path_, name) + "[" + std::to_string(i) + "]"));
    }
  }
  void require(bool holds, std::string_view name, std::string what, std::string remedy) {
    if (!holds) problems_.push_back({join_path(path_, name), std::move(what), std::move(remedy)});
  }

  [[nodiscard]] Problems take() && { return std::move(problems_); }

 private:
  void append(Problems more) {
    for (auto& problem : more) problems_.push_back(std::move(problem));
  }
  std::string path_;
  Problems problems_;
};

}  // namespace detail

/// The old keys of a struct, without those of its groups.
template <typename Config>
[[nodiscard]] std::vector<OldKey> old_keys(const Config& config) {
  detail::OldKeyCollector collector;
  Config::describe(config, collector);
  return std::move(collector).take();
}

template <typename Config>
Problems validate(const Config& config, std::string path) {
  detail::Validator validator(std::move(path));
  Config::describe(config, validator);
  return std::move(validator).take();
}

template <typename Config>
void require_valid(const Config& config, const std::string& place) {
  if (const Problems problems = validate(config); !problems.empty()) {
    detail::throw_problems(problems, place);
  }
}

}  // namespace strata
