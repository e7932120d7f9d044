// SPDX-License-Identifier: Apache-2.0
/// Keys of the version before: read as what they are called now, with a note each.
#pragma once

#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "components/settings/key_tree.hpp"

namespace strata::settings {

/// What to tell the user of a document that was read all the same: "PLACE:LINE: KEY is called ...".
using Notes = std::vector<std::string>;

/// The document with old names replaced by the present ones and keys that are gone left out; nodes
/// keep their lines. `node` itself stays as it is. Where both names are given, what --set says
/// wins. Throws ConfigError when a file gives both.
[[nodiscard]] YAML::Node with_present_keys(const YAML::Node& node, const std::string& place,
                                           const KeyTree& tree, Notes& notes);

/// Whether the struct has a key of this name, or had one in the version before; no dots. O(keys).
[[nodiscard]] bool is_key(const std::string& name, const KeyTree& tree);

/// The present form of a dotted key; empty for one that is gone. O(keys).
[[nodiscard]] std::string present_key(const std::string& key, const KeyTree& tree);

}  // namespace strata::settings
