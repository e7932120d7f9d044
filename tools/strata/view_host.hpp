// SPDX-License-Identifier: Apache-2.0
/// The live view beside what a verb does: --view.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <yaml-cpp/yaml.h>

#include "components/runtime/composition.hpp"
#include "components/runtime/host.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// 0: no live view.
inline constexpr int kViewPort = 8765;

/// Adds --view and --view=PORT, bound to `port`, which must outlive the app: 0 without.
void add_view_option(CLI::App& verb, int& port);

struct ViewOptions {
  int port = kViewPort;
  /// Others of strata::LiveView, as a composition gives them; those below win.
  YAML::Node parameters = YAML::Node(YAML::NodeType::Map);
  bool allow_commands = true;
  /// Topics are read from the start, and who comes later gets their newest message.
  bool keep_newest = false;
};

/// A strata::LiveView as a part of no composition: on this participant, ticked by a thread of its
/// own until the end.
class ViewHost {
 public:
  /// Tells the user where the page is. Throws ConfigError when the port is taken, or the
  /// composition has a live view.
  ViewHost(const runtime::Composition& composition, std::shared_ptr<bus::Participant> participant,
           const ViewOptions& options, VerbContext& context);
  ~ViewHost();
  ViewHost(const ViewHost&) = delete;
  ViewHost& operator=(const ViewHost&) = delete;

 private:
  runtime::Host host_;
  std::jthread ticks_;
};

/// None without a port.
[[nodiscard]] std::unique_ptr<ViewHost> view_of(const runtime::Composition& composition,
                                                std::shared_ptr<bus::Participant> participant,
                                                const ViewOptions& options, VerbContext& context);

}  // namespace strata::tools
