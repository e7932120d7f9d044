// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/verb_context.hpp"

#include <cerrno>
#include <cmath>
#include <cstdlib>
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

void VerbContext::clear_progress() {
  if (progress_) progress_->clear();
}

void VerbContext::note(std::string_view line) {
  if (options.quiet) return;
  clear_progress();
  std::cerr << line << std::endl;
}

namespace {

/// Longer than clocks differ, and short enough to be added to a stamp.
constexpr double kLongestOffset_s = 4e9;

std::string fault_of_real(const std::string& option, const std::string& text) {
  const double value = std::strtod(text.c_str(), nullptr);  // whether it is one CLI11 says itself
  if (std::isnan(value)) return text + " is no number to work with";
  if (std::isinf(value) && option != "--to") return text + " is infinite";
  if (option == "--from" && value < 0.0) return text + " is before the first scan";
  if (option == "--truth-offset" && std::abs(value) > kLongestOffset_s) {
    return text + " s is longer than clocks differ";
  }
  return "";
}

std::string fault_of_whole(const std::string& text) {
  if (text.find('-') != std::string::npos) return text + " is negative";
  errno = 0;
  (void)std::strtoull(text.c_str(), nullptr, 10);
  return errno == ERANGE ? text + " is too large" : "";
}

}  // namespace

void refuse_odd_numbers(CLI::App& app) {
  const auto all = [](const auto*) { return true; };
  for (CLI::App* verb : app.get_subcommands(all)) {
    refuse_odd_numbers(*verb);
    for (CLI::Option* option : verb->get_options(all)) {
      const std::string type = option->get_type_name();
      if (type.starts_with("FLOAT")) {
        option->check([name = option->get_name()](const std::string& text) {
          return fault_of_real(name, text);
        });
      } else if (type.starts_with("UINT")) {
        option->check([](const std::string& text) { return fault_of_whole(text); });
      }
    }
  }
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
