// SPDX-License-Identifier: Apache-2.0
/// `strata doctor`: what is on the domain, and what does not fit together.
#include <chrono>
#include <iostream>
#include <memory>
#include <string>

#include "components/bus/environment.hpp"
#include "components/bus/participant.hpp"
#include "core/base/error.hpp"
#include "tools/doctor/examination.hpp"
#include "tools/doctor/listen.hpp"
#include "tools/strata/positive.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {
namespace {

struct DoctorOptions {
  int domain = -1;
  std::string transport;
  double seconds = 3.0;
  bool all = false;
  bool json = false;
};

void examine(const DoctorOptions& options, VerbContext& context) {
  refuse_config(context.options, "use the options of `strata doctor --help`");
  bus::ParticipantOptions participant = bus::options_from_environment();
  if (options.domain >= 0) participant.domain = options.domain;
  if (!options.transport.empty()) {
    participant.transport = bus::transport_from_name(options.transport);
    participant.is_alone = false;  // as in a composition that names a transport
  }
  const auto listener = std::make_shared<bus::Participant>(participant);
  for (const std::string& warning : listener->warnings()) context.note("warning: " + warning);
  context.note("listening on domain " + std::to_string(participant.domain));
  const auto end = std::chrono::steady_clock::now() +
                   std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                       std::chrono::duration<double>(options.seconds));
  const doctor::Observed observed = doctor::listen(listener, [&](double seconds) {
    return !context.interrupt().wait_for(seconds) && std::chrono::steady_clock::now() < end;
  });
  const doctor::Report report = doctor::examine(observed);
  std::cout << (options.json ? doctor::to_json(report) : doctor::to_text(report, options.all))
            << std::flush;
  if (const std::size_t errors = report.errors(); errors > 0) {
    throw Error("domain " + std::to_string(participant.domain),
                counted(errors, "error was", "errors were") + " found", "see the findings above");
  }
}

}  // namespace

void add_doctor(CLI::App& app, VerbContext& context) {
  const auto [verb, options] = add_verb<DoctorOptions>(
      app, context, "doctor",
      "what does not match on the DDS domain, and what is on it; 1 when there are errors",
      "strata doctor --domain 7", examine);
  verb->add_option("--domain", options->domain, "ROS_DOMAIN_ID when left out")
      ->check(CLI::Range(0, 232));
  verb->add_option("--transport", options->transport,
                   bus::transport_names() + "; the environment's when left out");
  verb->add_option("--seconds", options->seconds, "how long to listen")->check(positive());
  verb->add_flag("--all", options->all, "also the topics of services, logs and parameters");
  verb->add_flag("--json", options->json, "JSON on standard output");
}

}  // namespace strata::tools
