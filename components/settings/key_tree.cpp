// SPDX-License-Identifier: Apache-2.0
#include "components/settings/key_tree.hpp"

#include <algorithm>

namespace strata::settings {

const KeyTree::Key* KeyTree::find(std::string_view name) const {
  const auto found =
      std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.name == name; });
  return found == keys.end() ? nullptr : &*found;
}

bool KeyTree::Key::is_for_users() const {
  if (is_field) return *info.when != '\0';
  return std::any_of(inside.keys.begin(), inside.keys.end(),
                     [](const Key& key) { return key.is_for_users(); });
}

}  // namespace strata::settings
