// SPDX-License-Identifier: Apache-2.0
/// The keys of a config struct without its values: what old names and presets are found by.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/config.hpp"

namespace strata::settings {

/// A struct's keys, in the order of `describe`.
struct KeyTree {
  struct Key;
  std::vector<Key> keys;
  std::vector<OldKey> old_keys;

  /// Null when there is none of that name. O(keys).
  [[nodiscard]] const Key* find(std::string_view name) const;
};

struct KeyTree::Key {
  std::string name;
  FieldInfo info;  ///< of a field
  KeyTree inside;  ///< of a group, or of each item of a list
  bool is_list = false;
  bool is_field = false;

  /// Whether a user touches it, or something in it; the others are for experts.
  [[nodiscard]] bool is_for_users() const;
};

namespace detail {

/// The visitor behind key_tree.
class KeyTreeBuilder {
 public:
  explicit KeyTreeBuilder(KeyTree& tree) : tree_(tree) {}

  template <typename T>
  void field(std::string_view name, const T& /*value*/, const FieldInfo& info) {
    tree_.keys.push_back({std::string(name), info, {}, false, true});
  }
  template <typename Group>
  void group(std::string_view name, const Group& group, const char* /*doc*/) {
    KeyTree::Key key{std::string(name), {}, {}, false, false};
    KeyTreeBuilder inner(key.inside);
    Group::describe(group, inner);
    tree_.keys.push_back(std::move(key));
  }
  template <typename Item>
  void list(std::string_view name, const std::vector<Item>& /*items*/, const char* /*doc*/) {
    KeyTree::Key key{std::string(name), {}, {}, true, false};
    KeyTreeBuilder inner(key.inside);
    const Item item{};
    Item::describe(item, inner);
    tree_.keys.push_back(std::move(key));
  }
  void require(bool, std::string_view, std::string_view, std::string_view) {}
  void renamed(std::string_view old_name, std::string_view new_name) {
    tree_.old_keys.push_back({std::string(old_name), std::string(new_name), ""});
  }
  void removed(std::string_view old_name, std::string_view reason) {
    tree_.old_keys.push_back({std::string(old_name), "", std::string(reason)});
  }

 private:
  KeyTree& tree_;
};

}  // namespace detail

template <typename Config>
[[nodiscard]] KeyTree key_tree() {
  KeyTree tree;
  detail::KeyTreeBuilder builder(tree);
  const Config config{};
  Config::describe(config, builder);
  return tree;
}

}  // namespace strata::settings
