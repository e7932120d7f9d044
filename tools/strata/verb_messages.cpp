// SPDX-License-Identifier: Apache-2.0
/// `strata messages OUT`: our messages as a package for ROS 2.
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "components/convert/message_package.hpp"
#include "core/base/error.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

void write(const convert::PackageFile& file, const fs::path& folder) {
  const fs::path path = folder / file.path;
  fs::create_directories(path.parent_path());
  std::ofstream out(path, std::ios::binary);
  out << file.text;
  out.close();
  if (!out) throw OutputError(path.string(), "cannot be written", "free some space");
}

void run(const std::string& target, VerbContext& context) {
  refuse_config(context.options, "messages have no settings");
  require_kind(target, "messages", context);
  OutputDirectory folder(target, context.staged());
  const auto files = convert::message_package("strata_msgs", STRATA_VERSION);
  for (const convert::PackageFile& file : files) write(file, folder.path());
  folder.commit();
  context.note(target + ": the package strata_msgs, " + std::to_string(files.size() - 2) +
               " messages");
}

}  // namespace

void add_messages(CLI::App& app, VerbContext& context) {
  const auto out = std::make_shared<std::string>();
  CLI::App* verb = add_verb(app, context, "messages", "our messages as a package for ROS 2's tools",
                            "strata messages src/strata_msgs && colcon build --packages-select "
                            "strata_msgs",
                            [out, &context] { run(*out, context); });
  verb->add_option("OUT", *out, "folder of the package strata_msgs, in a colcon workspace")
      ->required();
  add_force(*verb, context);
}

}  // namespace strata::tools
