// SPDX-License-Identifier: Apache-2.0
/// Writes config structs as YAML that read_config reads back to the same bits.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/base/config.hpp"

namespace strata::settings {

/// How write_yaml decorates.
struct WriteOptions {
  bool with_version = true;    ///< begin with "version: 1", as load_document wants
  bool with_comments = false;  ///< each field's unit and meaning behind it
};

/// Every key with its value, in the order of `describe`. read_config of the result gives an equal
/// struct (numbers in their shortest exact form).
template <typename Config>
[[nodiscard]] std::string write_yaml(const Config& config, const WriteOptions& options = {});

namespace detail {

[[nodiscard]] std::string yaml_text(bool value);
[[nodiscard]] std::string yaml_text(int value);
[[nodiscard]] std::string yaml_text(std::int64_t value);
[[nodiscard]] std::string yaml_text(std::uint64_t value);
[[nodiscard]] std::string yaml_text(double value);
/// Plain when that cannot be mistaken for anything else, double-quoted otherwise.
[[nodiscard]] std::string yaml_text(const std::string& value);

template <typename T>
[[nodiscard]] std::string yaml_text(const std::vector<T>& values) {
  std::string text = "[";
  for (const T& value : values) text += (text.size() > 1 ? ", " : "") + yaml_text(value);
  return text + "]";
}

/// Any field type.
template <typename T>
[[nodiscard]] std::string field_text(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    return yaml_text(std::string(enum_name(value)));
  } else {
    return yaml_text(value);
  }
}

[[nodiscard]] std::string comment_of(const FieldInfo& info);

/// The visitor behind write_yaml.
class Writer : public strata::detail::VisitorBase {
 public:
  Writer(std::string& out, std::size_t indent, bool with_comments)
      : out_(out), indent_(indent), with_comments_(with_comments) {}

  template <typename T>
  void field(std::string_view name, const T& value, const FieldInfo& info) {
    line(std::string(name) + ": " + field_text(value) + (with_comments_ ? comment_of(info) : ""));
  }
  template <typename Group>
  void group(std::string_view name, const Group& group, const char* doc) {
    line(std::string(name) + ":" + (with_comments_ ? comment_of({.doc = doc}) : ""));
    Writer inner(out_, indent_ + 2, with_comments_);
    Group::describe(group, inner);
  }
  template <typename Item>
  void list(std::string_view name, const std::vector<Item>& items, const char* doc) {
    const std::string comment = with_comments_ ? comment_of({.doc = doc}) : "";
    line(std::string(name) + ":" + (items.empty() ? " []" : "") + comment);
    for (const Item& item : items) {
      Writer inner(out_, indent_ + 4, with_comments_);
      inner.dash_ = true;
      Item::describe(item, inner);
      if (inner.dash_) inner.line("{}");
    }
  }

 private:
  void line(const std::string& text) {
    out_ += dash_ ? std::string(indent_ - 2, ' ') + "- " : std::string(indent_, ' ');
    out_ += text + "\n";
    dash_ = false;
  }
  std::string& out_;
  std::size_t indent_;
  bool with_comments_;
  bool dash_ = false;  ///< the next line begins a list item
};

}  // namespace detail

template <typename Config>
std::string write_yaml(const Config& config, const WriteOptions& options) {
  std::string text = options.with_version ? "version: 1\n" : "";
  detail::Writer writer(text, 0, options.with_comments);
  Config::describe(config, writer);
  return text;
}

}  // namespace strata::settings
