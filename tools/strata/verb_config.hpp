// SPDX-License-Identifier: Apache-2.0
/// --config and --set of a verb as one document.
#pragma once

#include <string>

#include <yaml-cpp/yaml.h>

#include "components/settings/config_reader.hpp"
#include "components/settings/yaml_document.hpp"
#include "core/base/error.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// The file named by --config (an empty document without one) with every --set applied, for
/// settings::read_config. Throws ConfigError or InputError.
[[nodiscard]] inline YAML::Node load_config(const CommonOptions& options) {
  YAML::Node document = options.config_file.empty() ? YAML::Node(YAML::NodeType::Map)
                                                    : settings::load_document(options.config_file);
  settings::apply_overrides(document, options.overrides);
  return document;
}
/// What to call that document in errors.
[[nodiscard]] inline std::string config_place(const CommonOptions& options) {
  return options.config_file.empty() ? std::string("--set") : options.config_file;
}

/// The settings of a verb, read and validated; what is to be told of them goes to the user. Throws
/// ConfigError or InputError.
template <typename Config>
[[nodiscard]] Config read_config(VerbContext& context) {
  settings::Notes notes;
  auto config = settings::read_config<Config>(load_config(context.options),
                                              config_place(context.options), {}, &notes);
  for (const std::string& note : notes) context.note("note: " + note);
  return config;
}

/// For verbs whose settings are elsewhere; remedy: where. Throws ConfigError when --config is
/// given.
inline void refuse_config(const CommonOptions& options, const std::string& remedy) {
  if (options.config_file.empty()) return;
  throw ConfigError("--config " + options.config_file, "does not apply to this verb", remedy);
}

}  // namespace strata::tools
