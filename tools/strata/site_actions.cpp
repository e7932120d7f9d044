// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/site_actions.hpp"

#include <array>
#include <chrono>
#include <iostream>
#include <utility>

#include <pwd.h>
#include <unistd.h>

namespace strata::tools {
namespace {

/// "ada@robot1".
std::string who_runs_this() {
  const passwd* user = getpwuid(geteuid());
  std::array<char, 256> host{};
  (void)gethostname(host.data(), host.size() - 1);
  return std::string(user != nullptr ? user->pw_name : "unknown") + "@" + host.data();
}

}  // namespace

site::Actor actor(const SiteOptions& options) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return {options.by.empty() ? who_runs_this() : options.by,
          std::chrono::duration_cast<std::chrono::nanoseconds>(now).count()};
}

site::Site open_site(const SiteOptions& options, VerbContext& context) {
  site::Site site(options.folder);
  site.wait_with(
      [&context, is_told = false, folder = options.folder](const std::string& holder) mutable {
        if (!std::exchange(is_told, true)) {
          context.note("waits for " + holder + ", which changes " + folder);
        }
        return !context.interrupt().wait_for(0.1);
      });
  return site;
}

void answer(const SiteOptions& options, VerbContext& context, const std::string& text,
            const nlohmann::json& as_json) {
  if (options.json) {
    std::cout << as_json.dump(2) << "\n";
  } else if (!context.options.quiet) {
    std::cout << text << "\n";
  }
}

void add_who(CLI::App& action, SiteOptions& options) {
  action.add_option("--by", options.by, "who does it, for the diary; by default USER@HOST");
}

void add_actions(CLI::App& group, std::span<const SiteAction> actions, SiteOptions& options) {
  group.require_subcommand(1);
  for (const SiteAction& action : actions) {
    CLI::App* added = group.add_subcommand(action.name, action.description);
    action.add_options(*added, options);
    added->footer("Example:\n  strata site " + group.get_name() + " site " + action.example);
    added->preparse_callback([&options, &action](std::size_t) { options.action = action.name; });
    added->fallthrough();
  }
}

void run_chosen(std::span<const SiteAction> actions, const SiteOptions& options,
                VerbContext& context) {
  for (const SiteAction& action : actions) {
    if (options.action == action.name) return action.run(options, context);
  }
}

}  // namespace strata::tools
