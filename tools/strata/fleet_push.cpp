// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/fleet_push.hpp"

#include <map>

#include "components/fleet/clock.hpp"
#include "components/fleet/push.hpp"
#include "components/log/content_hash.hpp"
#include "components/site/site.hpp"
#include "tools/report/plot.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {
namespace {

using nlohmann::json;

json json_of(const fleet::PushedVisit& visit) {
  return {{"run", visit.run},
          {"visit", visit.name.number},
          {"sha256", visit.name.sha256},
          {"scans", visit.scans},
          {"path_m", visit.path_m},
          {"bytes", visit.bytes},
          {"relative_to", visit.relative_to.empty() ? json(nullptr) : json(visit.relative_to)},
          {"outcome", fleet::name_of(visit.outcome)}};
}

/// What a robot's visits are told relative to; nothing where no site is named.
std::optional<fleet::Coding> coding_of(const FleetOptions& options) {
  if (options.against.empty()) return std::nullopt;
  const site::Site site(options.against);
  if (site.decisions().id != options.site) {
    throw InputError(options.against, "is site " + site.decisions().id + ", not " + options.site,
                     "two sites do not mix: name that site's folder");
  }
  return fleet::active_coding(site, options.tolerance_cells);
}

std::string why_not(const FleetOptions& options, const std::optional<fleet::Coding>& coding) {
  if (options.tolerance_cells <= 0.0) return "--tolerance 0 sends what was measured";
  if (!coding) return options.against + " has no active version with a filtered map";
  return "the server has not released version " + log::short_hash(coding->hash) +
         ", or they are smaller so, or cannot be told otherwise";
}

}  // namespace

FleetPushed push_visits(fleet::Connection& connection, const FleetOptions& options,
                        VerbContext& context) {
  const fleet::ClockOffset clock = fleet::clock_offset(connection);
  if (clock.is_off()) context.note("warning: " + clock.warning());
  FleetPushed pushed;
  json visits = json::array();
  std::map<fleet::PushOutcome, std::size_t> counts;
  std::size_t bytes = 0;
  double path_m = 0.0;
  std::size_t relative = 0;
  const auto told = [&](const fleet::PushedVisit& visit) {
    visits.push_back(json_of(visit));
    ++counts[visit.outcome];
    bytes += visit.bytes;
    if (!visit.relative_to.empty()) ++relative;
    if (visit.outcome == fleet::PushOutcome::kSent) path_m += visit.path_m;
    if (visit.outcome == fleet::PushOutcome::kClash) pushed.clash = visit.name;
    if (context.interrupt().requested()) throw Cancelled("push");
  };
  const std::optional<fleet::Coding> coding = coding_of(options);
  fleet::push(connection, options.site, options.folder, told, {.spacing_m = options.spacing_m},
              coding ? &*coding : nullptr);
  using enum fleet::PushOutcome;
  if (!options.against.empty() && relative < counts[kSent]) {
    context.note("warning: " + counted(counts[kSent] - relative, "visit") +
                 " went by themselves: " + why_not(options, coding));
  }
  pushed.text = "sent " + counted(counts[kSent], "visit") + ", " +
                report::fixed(static_cast<double>(bytes) / 1e3, 1) + " kB over " +
                report::fixed(path_m, 0) + " m; " + std::to_string(counts[kThere]) +
                " were there, " + std::to_string(counts[kReleased]) + " are in released maps";
  pushed.summary = {{"site", options.site},
                    {"bytes", bytes},
                    {"path_m", path_m},
                    {"clock_ahead_s", clock.ahead_s},
                    {"visits", visits}};
  return pushed;
}

}  // namespace strata::tools
