// SPDX-License-Identifier: Apache-2.0
/// `preset: NAME` in a document: several settings at once, such as what a paper's form of an
/// algorithm is. Which ones, the fields say themselves (FieldInfo::preset).
#pragma once

#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "components/settings/key_tree.hpp"

namespace strata::settings {

/// The key of a document that names a preset, or a list of them.
inline constexpr const char* kPresetKey = "preset";

/// One setting of a preset.
struct PresetLine {
  std::string preset;
  std::string key;    ///< dotted
  std::string value;  ///< as YAML
};

/// What every preset sets in this struct, in the order of `describe`. O(keys).
[[nodiscard]] std::vector<PresetLine> preset_lines(const KeyTree& tree);

/// Their names, each once, sorted.
[[nodiscard]] std::vector<std::string> preset_names(const KeyTree& tree);

/// The document with the settings of its presets in place of `preset`. What it says itself wins.
/// `document` stays as it is. Throws ConfigError for a preset that has nothing to set here, with
/// the names of those that have.
[[nodiscard]] YAML::Node with_presets(const YAML::Node& document, const std::string& place,
                                      const KeyTree& tree);

}  // namespace strata::settings
