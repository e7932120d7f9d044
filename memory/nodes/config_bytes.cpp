// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/config_bytes.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>

namespace strata::memory {
namespace {

/// Every value is a number or a text.
struct Value {
  double number = 0.0;
  std::string text;
};
using Values = std::map<std::string, Value>;

/// What files have called a setting since before it had its name.
std::string_view stored_name(std::string_view name) {
  if (name == "min_incidence_rad") return "min_incidence_rad";
  return name;
}

std::string joined(const std::string& path, std::string_view name) {
  return path.empty() ? std::string(name) : path + "." + std::string(name);
}

class Collector : public strata::detail::VisitorBase {
 public:
  Collector(Values& values, std::string path) : values_(values), path_(std::move(path)) {}
  template <typename T>
  void field(std::string_view name, const T& value, const FieldInfo& /*info*/) {
    Value& target = values_[joined(path_, stored_name(name))];
    if constexpr (std::is_arithmetic_v<T>) {
      target.number = static_cast<double>(value);
    } else {
      target.text = value;
    }
  }
  template <typename Group>
  void group(std::string_view name, const Group& group, const char* /*doc*/) {
    Collector inner(values_, joined(path_, name));
    Group::describe(group, inner);
  }
  template <typename Item>
  void list(std::string_view name, const std::vector<Item>& items, const char* /*doc*/) {
    values_[joined(path_, name) + ".size"].number = static_cast<double>(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
      group(std::string(name) + "." + std::to_string(i), items[i], "");
    }
  }

 private:
  Values& values_;
  std::string path_;
};

class Distributor : public strata::detail::VisitorBase {
 public:
  /// is_possible: becomes false when a number is none that its field can hold.
  Distributor(Values& values, std::string path, bool& is_possible)
      : values_(values), path_(std::move(path)), is_possible_(is_possible) {}
  /// Fills a struct.
  template <typename Config>
  void fill(Config& config) {
    for (const OldKey& key : old_keys(config)) {
      if (!key.new_name.empty()) rename(joined(path_, key.name), joined(path_, key.new_name));
    }
    Config::describe(config, *this);
  }
  template <typename T>
  void field(std::string_view name, T& value, const FieldInfo& /*info*/) {
    const auto found = values_.find(joined(path_, stored_name(name)));
    if (found == values_.end()) return;
    if constexpr (std::is_same_v<T, bool>) {
      value = found->second.number != 0.0;
    } else if constexpr (std::is_integral_v<T>) {
      value = number_of<T>(found->second.number);
    } else if constexpr (std::is_arithmetic_v<T>) {
      value = static_cast<T>(found->second.number);
    } else {
      value = found->second.text;
    }
  }
  template <typename Group>
  void group(std::string_view name, Group& group, const char* /*doc*/) {
    Distributor(values_, joined(path_, name), is_possible_).fill(group);
  }
  template <typename Item>
  void list(std::string_view name, std::vector<Item>& items, const char* /*doc*/) {
    const auto size = values_.find(joined(path_, name) + ".size");
    if (size == values_.end()) return;
    constexpr std::uint16_t kMaxItems = 1000;
    items.resize(std::min(kMaxItems, number_of<std::uint16_t>(size->second.number)));
    for (std::size_t i = 0; i < items.size(); ++i) {
      group(std::string(name) + "." + std::to_string(i), items[i], "");
    }
  }

 private:
  template <typename T>
  [[nodiscard]] T number_of(double number) {
    const bool is_there = number >= static_cast<double>(std::numeric_limits<T>::min()) &&
                          number <= static_cast<double>(std::numeric_limits<T>::max());
    is_possible_ = is_possible_ && is_there;
    return is_there ? static_cast<T>(number) : T{};
  }

  /// Files of before have a field, or all that is in a group, under its old name.
  void rename(const std::string& old_name, const std::string& new_name) {
    Values renamed;
    for (const auto& [name, value] : values_) {
      const bool is_it = name == old_name || name.starts_with(old_name + ".");
      if (is_it) renamed[new_name + name.substr(old_name.size())] = value;
    }
    values_.merge(renamed);
  }

  Values& values_;
  std::string path_;
  bool& is_possible_;
};

}  // namespace

void write_config(const TimescaleConfig& config, StateWriter& out) {
  Values values;
  Collector collector(values, "");
  TimescaleConfig::describe(config, collector);
  out(static_cast<std::uint32_t>(values.size()));
  for (const auto& [name, value] : values) {
    out(name);
    out(value.number);
    out(value.text);
  }
}

TimescaleConfig read_config(StateReader& in) {
  Values values;
  std::uint32_t count = 0;
  in(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::string name;
    in(name);
    Value& value = values[name];
    in(value.number);
    in(value.text);
  }
  TimescaleConfig config;
  bool is_possible = true;
  Distributor(values, "", is_possible).fill(config);
  if (!is_possible) in.fail("holds a setting that none can be");
  if (const Problems problems = validate(config); !problems.empty()) {
    in.fail("holds a configuration where " + problems[0].path + " " + problems[0].what);
  }
  return config;
}

}  // namespace strata::memory
