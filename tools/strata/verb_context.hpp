// SPDX-License-Identifier: Apache-2.0
/// What every verb is given: the common options, progress, a place for output.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/base/progress.hpp"
#include "tools/strata/interrupt.hpp"
#include "tools/strata/output_directory.hpp"
#include "tools/strata/terminal_progress.hpp"

namespace strata::tools {

/// What every verb takes; filled in before one runs.
struct CommonOptions {
  std::string config_file;             ///< --config; empty: defaults
  std::vector<std::string> overrides;  ///< --set key.path=value, in order
  bool quiet = false;
  std::uint64_t seed = 1;
  int threads = 0;     ///< 0: one per core; results do not depend on it
  bool force = false;  ///< --force, of verbs that have it (result_directory.hpp)
};

class VerbContext {
 public:
  VerbContext(Interrupt& interrupt, StagedPaths& staged) : interrupt_(interrupt), staged_(staged) {}

  CommonOptions options;

  /// Shows progress on stderr and throws Cancelled (through report_progress) after Ctrl-C.
  [[nodiscard]] Progress* progress();
  /// Of the work, as progress last told it; empty before.
  [[nodiscard]] std::string stage() const { return progress_ ? progress_->stage() : ""; }
  [[nodiscard]] Interrupt& interrupt() { return interrupt_; }
  [[nodiscard]] StagedPaths& staged() { return staged_; }
  /// Takes a bar of progress off the terminal, before results go there.
  void clear_progress();
  /// One line on stderr for the user, unless --quiet. Results go to stdout.
  void note(std::string_view line);

 private:
  Interrupt& interrupt_;
  StagedPaths& staged_;
  std::unique_ptr<TerminalProgress> progress_;
};

/// Adds `strata NAME` with the common options. `run` is called when the command line chose this
/// verb and was valid; it throws Error to fail. example: a whole command line. Returns the
/// subcommand, to which the verb adds its own options; variables they are bound to must be owned by
/// what `run` captures (a shared_ptr to a struct of options).
CLI::App* add_verb(CLI::App& app, VerbContext& context, const std::string& name,
                   const std::string& description, const std::string& example,
                   std::function<void()> run);

/// Makes every option of every verb that takes a number refuse what CLI11 takes for one: nan and,
/// but for --to, inf; a minus where there is no sign; a --from before the begin; a --truth-offset
/// that no stamp can take. Call it when all verbs are added.
void refuse_odd_numbers(CLI::App& app);

/// The same for a verb whose options are a struct of its own: it lives as long as the verb, and
/// `run` is given it.
template <class Options>
struct VerbOf {
  CLI::App* verb;
  std::shared_ptr<Options> options;
};
template <class Options>
VerbOf<Options> add_verb(CLI::App& app, VerbContext& context, const std::string& name,
                         const std::string& description, const std::string& example,
                         std::function<void(Options&, VerbContext&)> run) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(app, context, name, description, example,
                            [options, run = std::move(run), &context] { run(*options, context); });
  return {verb, std::move(options)};
}

}  // namespace strata::tools
