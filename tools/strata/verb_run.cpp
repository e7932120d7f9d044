// SPDX-License-Identifier: Apache-2.0
/// `strata run COMPOSITION.yaml`: starts the components over DDS until SIGINT or SIGTERM.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "components/runtime/host.hpp"
#include "components/settings/config_reader.hpp"
#include "core/base/error.hpp"
#include "tools/strata/all_components.hpp"
#include "tools/strata/composition_options.hpp"
#include "tools/strata/process_group.hpp"
#include "tools/strata/service_notice.hpp"
#include "tools/strata/verbs.hpp"

namespace strata::tools {
namespace {

struct RunOptions {
  std::string composition;
  std::string process;
  bool check = false;
  bool lockstep = false;
  pid_t parent = 0;     ///< of a process of a composition: who started it
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

/// To who started this process: the composition's, or systemd.
void tell_that_it_works(const RunOptions& options) {
  if (!options.is_child()) {
    tell_service_manager("READY=1");
  } else if (options.ready_pipe >= 0) {
    tell_ready(options.ready_pipe);
  }
}

void run_here(const RunOptions& options, VerbContext& context,
              const runtime::Composition& composition, const runtime::ProcessEntry& process) {
  runtime::HostOptions host_options;
  host_options.mode = options.lockstep ? runtime::FeedMode::kLockstep : runtime::FeedMode::kLive;
  host_options.seed = context.options.seed;
  host_options.threads = context.options.threads;
  const runtime::Registry registry = all_components(composition);
  const auto participant = runtime::make_participant(composition);
  if (composition.security.enabled && !participant->is_secured()) {
    context.note("warning: runs without security: enclave " + composition.enclave +
                 " is not in the keystore and ROS_SECURITY_STRATEGY is not Enforce");
  }
  runtime::Host host(composition, process, registry, participant, host_options);
  if (!options.lockstep) {
    host.activate();
    context.note("process " + process.name + " runs; Ctrl-C ends it");
    tell_that_it_works(options);
  }
  while (!context.interrupt().wait_for(0.1)) {
    if (!options.lockstep) host.tick();
    for (const std::string& error : host.take_errors()) context.note("warning: " + error);
  }
  if (!options.is_child()) tell_service_manager("STOPPING=1");
  host.stop();
}

/// When a process is to be started again.
class Restarts {
 public:
  using Clock = std::chrono::steady_clock;

  /// The delay before the next start; nothing when its policy is not to.
  std::optional<std::chrono::duration<double>> plan(const runtime::ProcessEntry& process,
                                                    bool failed) {
    const bool again = process.restart == runtime::Restart::kAlways ||
                       (process.restart == runtime::Restart::kOnFailure && failed);
    if (!again) return std::nullopt;
    State& state = states_[process.name];
    // Having run for a while, a process starts with a clean record.
    if (Clock::now() - state.started > kGoodRun) state.failures = 0;
    const double delay_s =
        std::min(kLongestDelay_s, process.restart_delay_s * std::pow(2.0, state.failures++));
    const std::chrono::duration<double> delay(delay_s);
    state.due = Clock::now() + std::chrono::duration_cast<Clock::duration>(delay);
    return delay;
  }
  void started(const std::string& name) {
    states_[name].started = Clock::now();
    states_[name].due.reset();
  }
  [[nodiscard]] bool is_due(const std::string& name) const {
    const auto found = states_.find(name);
    return found != states_.end() && found->second.due && *found->second.due <= Clock::now();
  }

 private:
  static constexpr double kLongestDelay_s = 60.0;
  static constexpr auto kGoodRun = std::chrono::minutes(1);
  struct State {
    Clock::time_point started;
    std::optional<Clock::time_point> due;
    int failures = 0;
  };
  std::map<std::string, State> states_;
};

void run_children(const RunOptions& options, VerbContext& context,
                  const runtime::Composition& composition) {
  ProcessGroup group;
  Restarts restarts;
  const auto start = [&](const std::string& name) {
    group.start(name, child_arguments(options.composition, name, context, false));
    restarts.started(name);
  };
  for (const runtime::ProcessEntry& process : composition.processes) start(process.name);
  const std::size_t count = composition.processes.size();
  bool is_told = false;
  while (!context.interrupt().wait_for(0.1)) {
    for (const ProcessGroup::Ended& ended : group.take_ended()) {
      const auto delay = restarts.plan(find_process(composition, ended.name), ended.failed);
      if (delay) {
        context.note("process " + ended.name + " has ended; it starts again in " +
                     std::to_string(delay->count()) + " s");
      } else if (ended.failed) {
        throw Error("process " + ended.name, "ended early", "see its message above");
      } else {
        return;
      }
    }
    for (const runtime::ProcessEntry& process : composition.processes) {
      if (restarts.is_due(process.name)) start(process.name);
    }
    if (!is_told && group.size() == count && group.all_ready()) {
      is_told = true;
      tell_that_it_works(options);
    }
  }
  tell_service_manager("STOPPING=1");
}

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
          prctl(PR_SET_PDEATHSIG, SIGTERM);
          // It may have died before: then nobody is left to end this process.
          if (getppid() != options->parent) return;
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
          run_children(*options, context, composition);
        }
      });
  verb->add_option("composition", options->composition, "composition file")->required();
  verb->get_option("--set")->description(kCompositionSetHelp);
  verb->get_option("--config")->description(kCompositionConfigHelp);
  verb->add_option("--process", options->process, "only this process of the composition");
  verb->add_flag("--check", options->check, "explain the composition, start nothing");
  verb->add_flag("--lockstep", options->lockstep)->group("");
  verb->add_option("--child", options->parent)->group("");
  verb->add_option("--ready-pipe", options->ready_pipe)->group("");
}

}  // namespace strata::tools
