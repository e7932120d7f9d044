// SPDX-License-Identifier: Apache-2.0
/// Configuration documents as YAML nodes: loading, the version line, and --set on top.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace strata::settings {

/// The one version of configuration documents so far.
inline constexpr int kDocumentVersion = 1;

/// Parses text. Throws ConfigError "PLACE:LINE: ..." when it is not YAML or not one map.
[[nodiscard]] YAML::Node parse_yaml(const std::string& text, const std::string& place);

/// Reads a configuration file, checks its `version: 1` line and takes it out of the result. Throws
/// InputError when the file cannot be read, ConfigError when it is not YAML, is not a map, or has a
/// missing or unknown version.
[[nodiscard]] YAML::Node load_document(const std::filesystem::path& file);

/// The same for text that is already in memory; place stands for the file name in errors.
[[nodiscard]] YAML::Node parse_document(const std::string& text, const std::string& place);

/// Applies "key.path=value" to a document; the value is YAML ("[1, 2]", "true", "office"). Groups
/// on the way are made when missing; "list[2].key" reaches into a list that has that item. An empty
/// value is the empty text. Throws ConfigError with the place "--set key.path=value" when the
/// option has no '=', an empty key, a value that is not YAML, or a path through something that is
/// no group.
void apply_override(YAML::Node& document, const std::string& option);

/// apply_override in order; later ones win.
void apply_overrides(YAML::Node& document, const std::vector<std::string>& options);

/// A copy whose nodes keep their places in `place` when they are put into a document of another
/// file.
[[nodiscard]] YAML::Node copy_with_places(const YAML::Node& node, const std::string& place);

/// A copy that shares nothing with the node, for place_of as the node is: a node that is put into
/// another document ties the two together, and one that lives long grows with each.
[[nodiscard]] YAML::Node copy_apart(const YAML::Node& node, const std::string& place);

/// Lets `copy` stand where `original` stood, for place_of.
void keep_place(YAML::Node& copy, const YAML::Node& original, const std::string& place);

/// Whether a node stood in a file, and not behind --set.
[[nodiscard]] bool has_place(const YAML::Node& node);

/// "PLACE:LINE" of a node; "--set" values have no line and give "--set PATH".
[[nodiscard]] std::string place_of(const YAML::Node& node, const std::string& place,
                                   const std::string& key_path);

}  // namespace strata::settings
