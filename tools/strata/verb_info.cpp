// SPDX-License-Identifier: Apache-2.0
/// `strata info LOG`: what is in a log.
#include <memory>
#include <string>

#include "core/base/error.hpp"
#include "tools/strata/verbs.hpp"

namespace strata::tools {

void add_info(CLI::App& app, VerbContext& context) {
  struct Options {
    std::string log;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(
      app, context, "info", "what is in a log", "strata info office.log.gz",
      [options] { throw InputError(options->log, "cannot be read yet", "use a later version"); });
  verb->add_option("LOG", options->log, "CARMEN log, rosbag2 folder, .db3 or .mcap")->required();
}

}  // namespace strata::tools
