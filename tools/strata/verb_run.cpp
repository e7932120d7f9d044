// SPDX-License-Identifier: Apache-2.0
/// `strata run COMPOSITION.yaml`: starts the components over DDS until SIGINT, SIGTERM or SIGHUP.
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "components/runtime/host.hpp"
#include "components/settings/config_reader.hpp"
#include "core/base/error.hpp"
#include "tools/all_components/all_components.hpp"
#include "tools/strata/composition_options.hpp"
#include "tools/strata/process_group.hpp"
#include "tools/strata/restarts.hpp"
#include "tools/strata/service_notice.hpp"
#include "tools/strata/shortage.hpp"
#include "tools/strata/verbs.hpp"
#include "tools/strata/view_host.hpp"

namespace strata::tools {
namespace {

struct RunOptions {
  std::string composition;
  std::string process;
  bool check = false;
  bool lockstep = false;
  pid_t parent = 0;     ///< of a process of a composition: who started it
  int view_port = 0;    ///< 0: no live view
  int ready_pipe = -1;  ///< of such a process: where to tell that it works
  [[nodiscard]] bool is_child() const { return parent != 0; }
};

const runtime::ProcessEntry& find_process(const runtime::Composition& composition,
                                          const std::string& name) {
  std::vector<std::string> known;
  for (const runtime::ProcessEntry& process : composition.processes) {
    if (process.name == name) return process;
    known.push_back(process.name);
  }
  throw ConfigError("--process", "the composition has no process '" + name + "'",
                    settings::detail::suggestion(name, known, "processes"));
}

double seconds_of(std::chrono::duration<double> time) { return time.count(); }

/// To who started this process: the composition's, or systemd.
void tell_that_it_works(const RunOptions& options) {
  if (!options.is_child()) {
    if (!options.lockstep) tell_service_manager("READY=1");
  } else if (options.ready_pipe >= 0) {
    tell_ready(options.ready_pipe);
  }
}

/// error: begins with the full name of one of the process's components.
std::string in_words(const std::string& error, const runtime::ProcessEntry& process) {
  const std::string who = error.substr(0, error.find(':'));
  for (const runtime::ComponentEntry& entry : process.components) {
    if (who.ends_with("/" + entry.name)) return shortage_in_words(error, entry.type, entry.name);
  }
  return shortage_in_words(error, "", "");
}

void tell(const std::vector<std::string>& errors, const runtime::ProcessEntry& process,
          VerbContext& context) {
  for (const std::string& error : errors) context.note("warning: " + in_words(error, process));
}

void run_here(const RunOptions& options, VerbContext& context,
              const runtime::Composition& composition, const runtime::ProcessEntry& process) {
  runtime::HostOptions host_options;
  host_options.mode = options.lockstep ? runtime::FeedMode::kLockstep : runtime::FeedMode::kLive;
  host_options.seed = context.options.seed;
  host_options.threads = context.options.threads;
  const runtime::Registry registry = all_components(composition);
  const auto participant = join(composition, context);
  runtime::Host host(composition, process, registry, participant, host_options);
  if (!options.lockstep) {
    host.activate();
    for (const auto& component : host.components()) {
      if (component->state() == runtime::LifecycleState::kActive) continue;
      context.note(component->full_name() + " is " + runtime::lifecycle_label(component->state()) +
                   " and waits for who manages it");
    }
    context.note("process " + process.name + " runs; Ctrl-C ends it");
  }
  const auto view = view_of(composition, participant, {.port = options.view_port}, context);
  tell_that_it_works(options);
  // From here on there is something to lose.
  context.interrupt().set_grace(seconds_of(kStopPatience));
  while (!context.interrupt().wait_for(0.1)) {
    if (!options.lockstep) host.tick();
    tell(host.take_errors(), process, context);
  }
  if (!options.is_child()) tell_service_manager("STOPPING=1");
  // What others sent until now is no loss of the end.
  tell(host.take_errors(), process, context);
  host.stop();
  // What could not be written at the end is lost: no clean end, whoever started this.
  if (auto errors = host.take_errors(); !errors.empty()) {
    const std::string first = in_words(errors.front(), process);
    errors.erase(errors.begin());
    tell(errors, process, context);
    throw Error("process " + process.name, "could not end well: " + first,
                "mend that before the next start; what was written before is kept");
  }
}

/// The processes of a composition, started and started again until one has ended for good.
class Supervision {
 public:
  Supervision(const RunOptions& options, VerbContext& context,
              const runtime::Composition& composition)
      : options_(options),
        context_(context),
        composition_(composition),
        group_({kStopPatience, [&context] { return context.interrupt().is_hurried(); }}) {}

  void run() {
    // The group's patience ends first; killed processes are told of.
    context_.interrupt().set_grace(seconds_of(kStopPatience) + 2.0, 5.0);
    // Here, so that the page lives on when a process is started again.
    std::unique_ptr<ViewHost> view;
    if (options_.view_port != 0) {
      view = view_of(composition_, join(composition_, context_), {.port = options_.view_port},
                     context_);
    }
    for (const runtime::ProcessEntry& process : composition_.processes) start(process.name);
    try {
      while (!context_.interrupt().wait_for(0.1) && tend()) {
      }
    } catch (const Error& failure) {
      // What could not even start is no service that stops.
      if (is_told_) tell_service_manager("STOPPING=1");
      const std::string loss = end_others(failure);
      if (loss.empty()) throw;
      throw Error(failure.place(), failure.problem() + "; then " + loss, failure.remedy());
    } catch (...) {
      if (is_told_) tell_service_manager("STOPPING=1");
      throw;
    }
    tell_service_manager("STOPPING=1");
    group_.stop();
  }

 private:
  void start(const std::string& name) {
    group_.start(name, child_arguments(options_.composition, name, context_, false));
    restarts_.started(name, Restarts::Clock::now());
  }

  /// Says at once why, since the others may take their time; returns which of them lost something.
  std::string end_others(const Error& failure) {
    if (group_.size() == 0) return "";
    context_.note(std::string("error: ") + failure.what() + "; the other processes end now");
    try {
      group_.stop();
    } catch (const Error& loss) {
      return loss.place() + " " + loss.problem();
    }
    return "";
  }

  /// Throws Error when some have failed for good; false when one has ended well for good.
  bool tend() {
    std::vector<std::string> failed;
    bool has_ended = false;
    for (const ProcessGroup::Ended& ended : group_.take_ended()) {
      const auto delay = restarts_.plan(find_process(composition_, ended.name), ended.failed,
                                        Restarts::Clock::now());
      if (delay) {
        context_.note("process " + ended.name + " has ended; it starts again in " +
                      std::to_string(delay->count()) + " s");
      } else if (ended.failed) {
        failed.push_back(ended.name);
      } else {
        has_ended = true;
      }
    }
    if (!failed.empty()) throw Error(processes(failed), "ended early", "see above what each said");
    if (has_ended) return false;
    start_again();
    if (!is_told_ && group_.size() == composition_.processes.size() && group_.all_ready()) {
      is_told_ = true;
      tell_that_it_works(options_);
    }
    return true;
  }

  void start_again() {
    for (const runtime::ProcessEntry& process : composition_.processes) {
      if (restarts_.is_due(process.name, Restarts::Clock::now())) start(process.name);
    }
  }

  const RunOptions& options_;
  VerbContext& context_;
  const runtime::Composition& composition_;
  Restarts restarts_;
  ProcessGroup group_;
  bool is_told_ = false;
};

}  // namespace

std::vector<std::string> child_arguments(const std::string& composition, const std::string& process,
                                         const VerbContext& context, bool lockstep) {
  std::vector<std::string> arguments = {"run",   composition, "--process",
                                        process, "--child",   std::to_string(getpid())};
  if (lockstep) arguments.emplace_back("--lockstep");
  if (context.options.quiet) arguments.emplace_back("--quiet");
  arguments.insert(arguments.end(), {"--seed", std::to_string(context.options.seed), "--threads",
                                     std::to_string(context.options.threads)});
  if (!context.options.config_file.empty()) {
    arguments.insert(arguments.end(), {"--config", context.options.config_file});
  }
  for (const std::string& setting : context.options.overrides) {
    arguments.insert(arguments.end(), {"--set", setting});
  }
  return arguments;
}

void add_run(CLI::App& app, VerbContext& context) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* verb = add_verb(
      app, context, "run", "start the components of a composition over DDS until Ctrl-C",
      "strata run components/config/mapping.yaml", [options, &context] {
        if (options->is_child()) {
          // What a process of an unfinished replay holds is of no use to anybody.
          prctl(PR_SET_PDEATHSIG, options->lockstep ? SIGKILL : SIGTERM);
          // It may have died before: then nobody is left to end this process.
          if (getppid() != options->parent) return;
          if (options->ready_pipe >= 0) keep_ready_pipe(options->ready_pipe);
          context.interrupt().ignore_further_signals();
        }
        // The parent has told what there is to tell.
        const runtime::Composition composition =
            options->is_child() ? load_composition(options->composition, context.options)
                                : load_composition(options->composition, context);
        if (options->check) {
          explain(composition);
        } else if (!options->process.empty()) {
          run_here(*options, context, composition, find_process(composition, options->process));
        } else if (composition.processes.size() == 1 &&
                   composition.processes.front().restart == runtime::Restart::kNever) {
          run_here(*options, context, composition, composition.processes.front());
        } else {
          Supervision(*options, context, composition).run();
        }
      });
  verb->footer(
      "Ctrl-C, SIGTERM or the end of its terminal (SIGHUP, unless under nohup) ends it:\n"
      "components write what they have learned, for " +
      std::to_string(kStopPatience.count()) +
      " s at most. The same signal again,\na second or more later, ends it at once.\n" +
      verb->get_footer());
  verb->add_option("composition", options->composition, "composition file")->required();
  verb->get_option("--set")->description(kCompositionSetHelp);
  verb->get_option("--config")->description(kCompositionConfigHelp);
  verb->add_option("--process", options->process, "only this process of the composition");
  add_view_option(*verb, options->view_port);
  verb->add_flag("--check", options->check, "explain the composition, start nothing");
  verb->add_flag("--lockstep", options->lockstep)->group("");
  verb->add_option("--child", options->parent)->group("");
  verb->add_option("--ready-pipe", options->ready_pipe)->group("");
}

}  // namespace strata::tools
