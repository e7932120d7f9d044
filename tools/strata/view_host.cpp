// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/view_host.hpp"

#include <chrono>
#include <utility>

#include "core/base/error.hpp"
#include "tools/all_components/all_components.hpp"

namespace strata::tools {
namespace {

constexpr const char* kType = "strata::LiveView";
constexpr auto kPeriod = std::chrono::milliseconds(50);

void require_no_other(const runtime::Composition& composition) {
  for (const runtime::ProcessEntry& process : composition.processes) {
    for (const runtime::ComponentEntry& entry : process.components) {
      if (entry.type != kType) continue;
      throw ConfigError("--view", entry.place + " has a " + kType + " already",
                        "leave --view out, or that component");
    }
  }
}

runtime::ProcessEntry process_of(const runtime::Composition& composition,
                                 const ViewOptions& options) {
  require_no_other(composition);
  runtime::ComponentEntry entry;
  entry.type = kType;
  entry.name = "live_view";
  entry.node_namespace = composition.node_namespace;
  entry.place = "--view";
  entry.parameters = YAML::Clone(options.parameters);
  entry.parameters["port"] = options.port;
  entry.parameters["allow_commands"] = options.allow_commands;
  entry.parameters["keep_newest"] = options.keep_newest;
  return {"view", runtime::ExecutorKind::kSingleThreaded, {entry}};
}

}  // namespace

void add_view_option(CLI::App& verb, int& port) {
  verb.add_flag("--view{" + std::to_string(kViewPort) + "}", port,
                "show it live in a browser: http://localhost:" + std::to_string(kViewPort) +
                    "/, or another port as --view=9000")
      ->check(CLI::Range(1, 65535));
}

ViewHost::ViewHost(const runtime::Composition& composition,
                   std::shared_ptr<bus::Participant> participant, const ViewOptions& options,
                   VerbContext& context)
    : host_(composition, process_of(composition, options), all_components(), std::move(participant),
            {}) {
  host_.activate();
  context.note("the live view is at http://localhost:" + std::to_string(options.port) + "/");
  ticks_ = std::jthread([this](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      host_.tick();
      std::this_thread::sleep_for(kPeriod);
    }
  });
}

ViewHost::~ViewHost() {
  ticks_ = {};  // joined
  host_.stop();
}

std::unique_ptr<ViewHost> view_of(const runtime::Composition& composition,
                                  std::shared_ptr<bus::Participant> participant,
                                  const ViewOptions& options, VerbContext& context) {
  if (options.port == 0) return nullptr;
  return std::make_unique<ViewHost>(composition, std::move(participant), options, context);
}

}  // namespace strata::tools
