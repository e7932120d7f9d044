// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/fleet_actions.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iostream>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>
#include <sys/random.h>

#include "components/fleet/pull.hpp"
#include "components/fleet/push.hpp"
#include "components/fleet/schema.hpp"
#include "components/fleet/status.hpp"
#include "components/log/content_hash.hpp"
#include "components/log/json_text.hpp"
#include "core/base/hex_text.hpp"
#include "tools/report/plot.hpp"
#include "tools/strata/fleet_learn.hpp"
#include "tools/strata/fleet_push.hpp"
#include "tools/strata/site_actions.hpp"
#include "tools/strata/site_text.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {
namespace {

using nlohmann::json;

fleet::Connection connect(const FleetOptions& options) {
  return fleet::Connection(options.url, {.statement_s = options.timeout_s});
}

void answer(const FleetOptions& options, VerbContext& context, const std::string& text,
            const json& as_json) {
  if (options.json) {
    std::cout << log::json_text(as_json);
  } else if (!context.options.quiet) {
    std::cout << text << "\n";
  }
}

site::Site open_site(const FleetOptions& options, VerbContext& context) {
  SiteOptions local;
  local.folder = options.folder;
  return tools::open_site(local, context);
}

site::Actor actor(const FleetOptions& options) {
  SiteOptions local;
  local.by = options.by;
  return tools::actor(local);
}

/// 128 bits from the system, as hexadecimal digits, which no URL and no shell minds.
std::string made_password() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw OutputError("the system", "gives no random numbers", "give --password-file");
  }
  return hex_text(bytes);
}

std::string password_in(const std::string& file) {
  std::ifstream in(file);
  std::string line;
  if (!std::getline(in, line) || line.empty()) {
    throw InputError(file, "has no password in its first line", "write one there");
  }
  return line;
}

void init(const FleetOptions& options, VerbContext& context) {
  fleet::Connection connection = connect(options);
  const bool made_tables = fleet::apply_schema(connection);
  const bool made_site = fleet::add_site(connection, options.site, options.frame);
  answer(options, context,
         std::string(made_site ? "made" : "there is already") + " site " + options.site + " on " +
             connection.place() + "; add robots with `strata fleet add-robot`",
         {{"site", options.site},
          {"frame", options.frame},
          {"server", connection.place()},
          {"made_tables", made_tables},
          {"made_site", made_site},
          {"schema_version", fleet::kSchemaVersion}});
}

void add_member(const FleetOptions& options, VerbContext& context, fleet::MemberKind kind) {
  fleet::Connection connection = connect(options);
  fleet::require_schema(connection);
  const bool is_made = options.password_file.empty();
  const std::string password = is_made ? made_password() : password_in(options.password_file);
  fleet::Renewed made{{}, true};
  if (options.new_password) {
    made = fleet::renew_password(connection, kind, options.site, options.name, password);
  } else {
    made.member = fleet::add_member(connection, kind, options.site, options.name, password);
  }
  const fleet::Member& member = made.member;
  if (!made.ended_sessions) {
    context.note("warning: who is logged in as " + member.role +
                 " stays so; as a superuser: SELECT pg_terminate_backend(pid) FROM "
                 "pg_stat_activity WHERE usename = '" +
                 member.role + "', then once more --new-password");
  }
  const std::string url = fleet::url_for(connection.place(), member.role);
  answer(options, context,
         std::string(options.new_password ? "gave a new password to " : "added ") +
             fleet::name_of(kind) + " " + member.name + " of " + member.site +
             (is_made ? "; its password, told this once: " + password : "") + "\n" + url,
         {{"kind", fleet::name_of(kind)},
          {"site", member.site},
          {"name", member.name},
          {"role", member.role},
          {"url", url},
          {"password", is_made ? json(password) : json(nullptr)}});
}

json json_of(const fleet::ServerVersion& version) {
  return {{"mapHash", version.hash},
          {"state", version.state},
          {"by", version.by},
          {"at", version.at},
          {"note", version.note}};
}

/// Who names a version so runs the same command every night: to go back is no such thing.
bool is_moving_name(const std::string& version) {
  return version == "active" || version == "newest" || version == "previous";
}

void release(const FleetOptions& options, VerbContext& context) {
  const site::Site site = open_site(options, context);
  fleet::Connection connection = connect(options);
  const std::string hash = site.find(options.version).version.hash;
  bool is_new = true;
  if (options.again || !is_moving_name(options.version)) {
    fleet::release(connection, site, hash, options.note);
  } else {
    is_new = fleet::release_once(connection, site, hash, options.note);
  }
  answer(options, context,
         std::string(is_new ? "released version " : "robots have been given version ") +
             log::short_hash(hash) + " of " + site.decisions().id + (is_new ? "" : " already"),
         {{"mapId", site.decisions().id},
          {"mapHash", hash},
          {"state", "released"},
          {"is_new", is_new}});
}

void withdraw(const FleetOptions& options, VerbContext& context) {
  fleet::Connection connection = connect(options);
  (void)fleet::require_member(connection, options.site);
  std::vector<std::string> meant;
  for (const fleet::ServerVersion& one : fleet::versions(connection, options.site)) {
    if (options.version.size() >= 4 && one.hash.starts_with(options.version)) {
      meant.push_back(one.hash);
    }
  }
  if (meant.size() > 1) {
    throw InputError(options.version, "begins several hashes", "give more of its digits");
  }
  const std::string hash = meant.empty() ? options.version : meant.front();
  fleet::withdraw(connection, options.site, hash);
  answer(options, context, "withdrew version " + log::short_hash(hash),
         {{"mapId", options.site}, {"mapHash", hash}, {"state", "withdrawn"}});
}

void push(const FleetOptions& options, VerbContext& context) {
  fleet::Connection connection = connect(options);
  const FleetPushed pushed = push_visits(connection, options, context);
  answer(options, context, pushed.text, pushed.summary);
  if (pushed.clash) throw fleet::clash_error(connection, *pushed.clash);
}

void pull(const FleetOptions& options, VerbContext& context) {
  site::Site site = open_site(options, context);
  fleet::Connection connection = connect(options);
  const auto pulled =
      fleet::pull(connection, site,
                  {.approve = options.approve || options.activate, .activate = options.activate},
                  actor(options));
  if (!pulled) {
    answer(options, context, "no version was released yet", nullptr);
    return;
  }
  json as_json = tools::json_of(pulled->status);
  as_json["is_new"] = pulled->is_new;
  as_json["released"] = json_of(pulled->version);
  as_json["removed"] = json::array();
  if (options.activate) {
    for (const auto& gone : fleet::collect(site, options.keep_retired, actor(options))) {
      as_json["removed"].push_back(gone.version.hash);
    }
  }
  const std::size_t removed = as_json["removed"].size();
  answer(options, context,
         std::string(pulled->is_new ? "pulled version " : "had version ") +
             name_of(pulled->status) + ", " + site::name_of(pulled->status.state) +
             (removed == 0 ? "" : "; removed " + counted(removed, "old version")),
         as_json);
}

void learn(const FleetOptions& options, VerbContext& context) {
  const site::Site site = open_site(options, context);
  fleet::Connection connection = connect(options);
  FleetLearnTask task{options.name, std::nullopt, options.without};
  if (!options.unchecked) task.limits = {options.max_contradicted, options.max_above_others};
  const json summary = learn_fleet(connection, site, task, context);
  context.clear_progress();
  answer(options, context,
         "learned " + counted(summary["visits"].get<std::size_t>(), "visit") + " of " +
             counted(summary["robots"].size(), "robot") + " on top of the active version" +
             set_aside_in(summary) + "; maps in " + options.name +
             ", add them with `strata site add " + options.folder + " " + options.name + "`",
         summary);
}

void set_aside(const FleetOptions& options, VerbContext& context) {
  if (options.why.empty() != options.undo) {
    throw InputError("command line", "says not why", "give --why 'REASON', or --undo");
  }
  fleet::Connection connection = connect(options);
  fleet::set_aside(connection, options.site, options.name, options.why);
  answer(options, context,
         options.name + (options.undo ? " is learned from again" : " is set aside"),
         {{"site", options.site},
          {"robot", options.name},
          {"set_aside", options.undo ? json(nullptr) : json(options.why)}});
}

json json_of(const fleet::SiteStatus& found) {
  json robots = json::array();
  for (const fleet::RobotStatus& robot : found.robots) {
    robots.push_back(
        {{"robot", robot.robot},
         {"visits", robot.visits},
         {"bytes", robot.bytes},
         {"path_m", robot.path_m},
         {"last", robot.last.empty() ? json(nullptr) : json(robot.last)},
         {"set_aside", robot.set_aside.empty() ? json(nullptr) : json(robot.set_aside)}});
  }
  json versions = json::array();
  for (const fleet::ServerVersion& version : found.versions) versions.push_back(json_of(version));
  return {{"site", found.site},
          {"frame", found.frame},
          {"role", found.me.role},
          {"kind", fleet::name_of(found.me.kind)},
          {"encrypted", found.is_encrypted},
          {"robots", robots},
          {"versions", versions}};
}

void status(const FleetOptions& options, VerbContext& context) {
  fleet::Connection connection = connect(options);
  const fleet::SiteStatus found = fleet::status(connection, options.site);
  std::string text = "site " + found.site + ", frame " + found.frame + "; asked as " +
                     fleet::name_of(found.me.kind) + " " + found.me.role +
                     (found.is_encrypted ? ", encrypted" : ", not encrypted");
  for (const fleet::RobotStatus& robot : found.robots) {
    text += "\n  " + robot.robot + ": " + std::to_string(robot.visits) + " visits, " +
            report::fixed(robot.path_m / 1e3, 2) + " km, " +
            report::fixed(static_cast<double>(robot.bytes) / 1e3, 1) + " kB" +
            (robot.last.empty() ? "" : ", last " + robot.last) +
            (robot.set_aside.empty() ? "" : "; SET ASIDE: " + robot.set_aside);
  }
  for (const fleet::ServerVersion& version : found.versions) {
    text += "\n  version " + log::short_hash(version.hash) + ": " + version.state + " " +
            version.at + " by " + version.by + (version.note.empty() ? "" : ": " + version.note);
  }
  answer(options, context, text, json_of(found));
}

}  // namespace

void run_fleet_action(const std::string& name, const FleetOptions& options, VerbContext& context) {
  if (name != "learn") refuse_config(context.options, "a fleet's server has no settings");
  if (name == "init") return init(options, context);
  if (name == "add-robot") return add_member(options, context, fleet::MemberKind::kRobot);
  if (name == "add-operator") return add_member(options, context, fleet::MemberKind::kOperator);
  if (name == "release") return release(options, context);
  if (name == "withdraw") return withdraw(options, context);
  if (name == "push") return push(options, context);
  if (name == "pull") return pull(options, context);
  if (name == "learn") return learn(options, context);
  if (name == "set-aside") return set_aside(options, context);
  if (name == "status") return status(options, context);
  throw InputError("fleet " + name, "is no action", "see `strata fleet --help`");
}

}  // namespace strata::tools
