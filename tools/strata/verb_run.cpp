// SPDX-License-Identifier: Apache-2.0
/// `strata run COMPOSITION.yaml`: starts the components over DDS until SIGINT or SIGTERM.
#include <memory>
#include <string>

#include <signal.h>
#include <sys/prctl.h>

#include "components/runtime/composition.hpp"
#include "components/runtime/host.hpp"
#include "tools/strata/all_components.hpp"
#include "tools/strata/process_group.hpp"
#include "tools/strata/service_notice.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"

namespace strata::tools {
namespace {

struct RunOptions {
  std::string composition;
  std::string process;
  bool check = false;
  bool lockstep = false;
  bool child = false;
};

const runtime::ProcessEntry& find_process(const runtime::Composition& composition,
                                          const std::string& name) {
  std::string known;
  for (const runtime::ProcessEntry& process : composition.processes) {
    if (process.name == name) return process;
    known += (known.empty() ? "" : ", ") + process.name;
  }
  throw ConfigError("--process", "the composition has no process '" + name + "'",
                    "choose one of " + known);
}

void run_here(const RunOptions& options, VerbContext& context,
              const runtime::Composition& composition, const runtime::ProcessEntry& process) {
  runtime::HostOptions host_options;
  host_options.mode = options.lockstep ? runtime::FeedMode::kLockstep : runtime::FeedMode::kLive;
  host_options.seed = context.options.seed;
  host_options.threads = context.options.threads;
  const runtime::Registry registry = all_components();
  runtime::Host host(composition, process, registry, runtime::make_participant(composition),
                     host_options);
  if (options.check) return;
  if (!options.lockstep) {
    host.activate();
    context.note("process " + process.name + " runs; Ctrl-C ends it");
    if (!options.child) tell_service_manager("READY=1");
  }
  while (!context.interrupt().wait_for(0.1)) {
    if (!options.lockstep) host.tick();
    for (const std::string& error : host.take_errors()) context.note("warning: " + error);
  }
  if (!options.child) tell_service_manager("STOPPING=1");
  host.stop();
}

void run_children(const RunOptions& options, VerbContext& context,
                  const runtime::Composition& composition) {
  ProcessGroup group;
  for (const runtime::ProcessEntry& process : composition.processes) {
    group.start(process.name, child_arguments(options.composition, process.name, context, false));
  }
  tell_service_manager("READY=1");
  while (!context.interrupt().wait_for(0.1)) {
    if (!group.all_run()) break;
  }
}

}  // namespace

std::vector<std::string> child_arguments(const std::string& composition, const std::string& process,
                                         const VerbContext& context, bool lockstep) {
  std::vector<std::string> arguments = {"run", composition, "--process", process, "--child"};
  if (lockstep) arguments.emplace_back("--lockstep");
  if (context.options.quiet) arguments.emplace_back("--quiet");
  arguments.insert(arguments.end(), {"--seed", std::to_string(context.options.seed), "--threads",
                                     std::to_string(context.options.threads)});
  for (const std::string& setting : context.options.overrides) {
    arguments.insert(arguments.end(), {"--set", setting});
  }
  return arguments;
}

void add_run(CLI::App& app, VerbContext& context) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* verb = add_verb(
      app, context, "run", "Start the components of a composition over DDS until Ctrl-C",
      "strata run components/config/mapping.yaml", [options, &context] {
        refuse_config(context.options, kConfigRemedy);
        if (options->child) prctl(PR_SET_PDEATHSIG, SIGTERM);
        const runtime::Composition composition =
            runtime::load_composition(options->composition, context.options.overrides);
        if (!options->process.empty()) {
          run_here(*options, context, composition, find_process(composition, options->process));
        } else if (options->check || composition.processes.size() == 1) {
          for (const runtime::ProcessEntry& process : composition.processes) {
            run_here(*options, context, composition, process);
          }
        } else {
          run_children(*options, context, composition);
        }
      });
  verb->add_option("composition", options->composition, "composition file")->required();
  verb->get_option("--set")->description(kCompositionSetHelp);
  verb->add_option("--process", options->process, "only this process of the composition");
  verb->add_flag("--check", options->check, "configure all components, then end");
  verb->add_flag("--lockstep", options->lockstep)->group("");
  verb->add_flag("--child", options->child)->group("");
}

}  // namespace strata::tools
