// SPDX-License-Identifier: Apache-2.0
#include "components/settings/old_keys.hpp"

#include <algorithm>
#include <utility>

#include "components/settings/yaml_document.hpp"
#include "core/base/error.hpp"

namespace strata::settings {
namespace {

const OldKey* old_key(const KeyTree& tree, const std::string& name) {
  const auto found = std::find_if(tree.old_keys.begin(), tree.old_keys.end(),
                                  [&](const OldKey& key) { return key.name == name; });
  return found == tree.old_keys.end() ? nullptr : &*found;
}

/// Whether any key of the document has another name now, or none.
bool has_old_keys(const YAML::Node& node, const KeyTree& tree) {
  if (!node.IsMap()) return false;
  return std::any_of(node.begin(), node.end(), [&](const auto& item) {
    const std::string name = item.first.IsScalar() ? item.first.Scalar() : "";
    if (old_key(tree, name) != nullptr) return true;
    const KeyTree::Key* const key = tree.find(name);
    if (key == nullptr || key->is_field) return false;
    if (!key->is_list) return has_old_keys(item.second, key->inside);
    return item.second.IsSequence() &&
           std::any_of(item.second.begin(), item.second.end(),
                       [&](const auto& one) { return has_old_keys(one, key->inside); });
  });
}

/// Walks one document; `notes_` grows.
class Renamer {
 public:
  Renamer(const std::string& place, Notes& notes) : place_(place), notes_(notes) {}

  YAML::Node present(const YAML::Node& node, const std::string& path, const KeyTree& tree) {
    if (!node.IsMap()) return node;
    YAML::Node copy(YAML::NodeType::Map);
    bool is_same = true;
    for (const auto& item : node) {
      // What is no text, unknown or given twice is for the reader to complain of.
      const std::string name = item.first.IsScalar() ? item.first.Scalar() : "";
      const OldKey* const old = old_key(tree, name);
      if (old == nullptr && is_beaten(node, name, tree)) continue;
      if (old == nullptr) {
        const YAML::Node value = inside(item.second, path, tree.find(name));
        is_same = is_same && value.is(item.second);
        copy.force_insert(item.first, value);
        continue;
      }
      is_same = false;
      const std::string where = place_of(item.first, place_, strata::detail::join_path(path, name));
      tell(*old, where, path);
      if (old->new_name.empty()) continue;
      const YAML::Node rival = node[old->new_name];
      if (rival.IsDefined()) {
        refuse_two_of_files(item.second, rival, *old, where, path);
        if (has_place(item.second)) continue;
      }
      YAML::Node key(old->new_name);
      keep_place(key, item.first, place_);
      copy.force_insert(key, inside(item.second, path, tree.find(old->new_name)));
    }
    if (is_same) return node;
    keep_place(copy, node, place_);
    return copy;
  }

 private:
  void tell(const OldKey& old, const std::string& where, const std::string& path) {
    const std::string full = strata::detail::join_path(path, old.name);
    if (old.new_name.empty()) {
      notes_.push_back(where + ": " + full + " is gone and is left out: " + old.reason);
      return;
    }
    notes_.push_back(where + ": " + full + " is called " +
                     strata::detail::join_path(path, old.new_name) +
                     " now; the next version will not know the old name");
  }

  void refuse_two_of_files(const YAML::Node& value, const YAML::Node& rival, const OldKey& old,
                           const std::string& where, const std::string& path) const {
    if (!has_place(value) || !has_place(rival)) return;
    throw ConfigError(where,
                      strata::detail::join_path(path, old.name) + " is given, and " + old.new_name +
                          ", which it is called now, too",
                      "remove " + old.name);
  }

  /// Whether --set gives this key under its old name.
  [[nodiscard]] static bool is_beaten(const YAML::Node& node, const std::string& name,
                                      const KeyTree& tree) {
    return std::any_of(tree.old_keys.begin(), tree.old_keys.end(), [&](const OldKey& old) {
      if (old.new_name != name) return false;
      const YAML::Node rival = node[old.name];
      return rival.IsDefined() && !has_place(rival);
    });
  }

  YAML::Node inside(const YAML::Node& value, const std::string& path, const KeyTree::Key* key) {
    if (key == nullptr || key->is_field) return value;
    const std::string full = strata::detail::join_path(path, key->name);
    if (!key->is_list) return present(value, full, key->inside);
    if (!value.IsSequence()) return value;
    YAML::Node copy(YAML::NodeType::Sequence);
    bool is_same = true;
    for (std::size_t i = 0; i < value.size(); ++i) {
      const YAML::Node item = present(value[i], full + "[" + std::to_string(i) + "]", key->inside);
      is_same = is_same && item.is(value[i]);
      copy.push_back(item);
    }
    if (is_same) return value;
    keep_place(copy, value, place_);
    return copy;
  }

  const std::string& place_;
  Notes& notes_;
};

}  // namespace

YAML::Node with_present_keys(const YAML::Node& node, const std::string& place, const KeyTree& tree,
                             Notes& notes) {
  if (!has_old_keys(node, tree)) return node;
  return Renamer(place, notes).present(copy_apart(node, place), "", tree);
}

bool is_key(const std::string& name, const KeyTree& tree) {
  return tree.find(name) != nullptr || old_key(tree, name) != nullptr;
}

std::string present_key(const std::string& key, const KeyTree& tree) {
  const std::size_t dot = key.find('.');
  const std::string first = key.substr(0, dot);
  const OldKey* const old = old_key(tree, first);
  if (old != nullptr && old->new_name.empty()) return "";
  const std::string name = old == nullptr ? first : old->new_name;
  if (dot == std::string::npos) return name;
  const KeyTree::Key* const found = tree.find(name);
  if (found == nullptr || found->is_field) return name + key.substr(dot);
  const std::string rest = present_key(key.substr(dot + 1), found->inside);
  return rest.empty() ? "" : name + "." + rest;
}

}  // namespace strata::settings
