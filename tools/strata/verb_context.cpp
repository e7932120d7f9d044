// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/verb_context.hpp"

#include <iostream>
#include <utility>

#include <unistd.h>

namespace strata::tools {

Progress* VerbContext::progress() {
  if (!progress_) {
    auto style = isatty(STDERR_FILENO) != 0 ? TerminalProgress::Style::kBar
                                            : TerminalProgress::Style::kLines;
    if (options.quiet) style = TerminalProgress::Style::kQuiet;
    progress_ = std::make_unique<TerminalProgress>(std::cerr, style, &interrupt_);
  }
  return progress_.get();
}

void VerbContext::note(std::string_view line) {
  if (options.quiet) return;
  if (progress_) progress_->clear();
  std::cerr << line << std::endl;
}

CLI::App* add_verb(CLI::App& app, VerbContext& context, const std::string& name,
                   const std::string& description, const std::string& example,
                   std::function<void()> run) {
  CLI::App* verb = app.add_subcommand(name, description);
  CommonOptions& options = context.options;
  verb->add_option("--config", options.config_file, "settings as YAML (version: 1)")
      ->group("Common");
  verb->add_option("--set", options.overrides,
                   "one setting, key.path=value, or preset=NAME; may be repeated. "
                   "docs/reference lists first what users touch, then what is for experts")
      ->take_all()
      ->allow_extra_args(false)
      ->group("Common");
  verb->add_flag("--quiet", options.quiet, "no progress, no notes")->group("Common");
  verb->add_option("--seed", options.seed, "of all randomness")
      ->capture_default_str()
      ->group("Common");
  verb->add_option("--threads", options.threads, "0: one per core; changes no result")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str()
      ->group("Common");
  verb->footer("Example:\n  " + example);
  verb->callback(std::move(run));
  return verb;
}

}  // namespace strata::tools
