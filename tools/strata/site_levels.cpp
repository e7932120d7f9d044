// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/site_levels.hpp"

#include <algorithm>
#include <array>

#include "components/log/text.hpp"
#include "core/base/error.hpp"
#include "tools/strata/site_text.hpp"
#include "tools/strata/warning.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {
namespace {

using nlohmann::json;

json json_of(const site::Level& level) {
  const site::Site site(level.folder);
  json text{{"name", level.name},
            {"elevation_m", level.elevation_m},
            {"folder", level.folder.string()},
            {"mapId", site.decisions().id},
            {"versions", site.versions().size()},
            {"active", nullptr}};
  if (const auto active = site.active()) text["active"] = tools::json_of(site.find(*active));
  return text;
}

std::string level_words(const site::Level& level) {
  const site::Site site(level.folder);
  const auto active = site.active();
  return level.name + " at " + log::format_number(level.elevation_m) + " m, " +
         site.decisions().id + ": " +
         (active ? "version " + name_of(site.find(*active)) + " is active"
                 : "no active version, of " + counted(site.versions().size(), "version"));
}

void list_levels(const SiteOptions& options, VerbContext& context) {
  const site::Site site = open_site(options, context);
  json all = json::array();
  const auto levels = site.levels();
  std::string text = counted(levels.size(), "level");
  for (auto level = levels.rbegin(); level != levels.rend(); ++level) {
    text += "\n  " + level_words(*level);  // the highest on top, as in the building
  }
  for (const site::Level& level : levels) all.push_back(json_of(level));
  warn(context, unknown_lift_levels(site));
  answer(options, context, text, all);
}

void add_level(const SiteOptions& options, VerbContext& context) {
  site::Site site = open_site(options, context);
  const LevelOptions& wanted = options.level;
  const std::string id = wanted.id.empty() ? site.decisions().id + "-" + wanted.name : wanted.id;
  const site::Level made = site.add_level(wanted.name, wanted.elevation_m, id, actor(options));
  answer(options, context,
         "made level " + made.name + "; add its maps with `strata site add " +
             made.folder.string() + " MAPS`",
         json_of(made));
}

void remove_level(const SiteOptions& options, VerbContext& context) {
  site::Site site = open_site(options, context);
  site.remove_level(options.level.name, actor(options));
  json names = json::array();
  for (const site::Level& level : site.levels()) names.push_back(level.name);
  answer(options, context, "removed level " + options.level.name, names);
}

constexpr std::array<SiteAction, 3> kLevelActions{{
    {"list", "every level, with the version that robots localize in there", "list --json",
     list_levels, [](CLI::App&, SiteOptions&) {}},
    {"add", "make a level; its maps are added to SITE/levels/NAME, which is a site",
     "add 1 --elevation 3.5", add_level,
     [](CLI::App& action, SiteOptions& options) {
       action.add_option("NAME", options.level.name, "letters, digits, '-', '_' and '.'")
           ->required();
       action.add_option("--elevation", options.level.elevation_m, "of its floor, in metres")
           ->required();
       action.add_option("--id", options.level.id,
                         "its name, VDA 5050's mapId; by default the building's, '-' and NAME");
       add_who(action, options);
     }},
    {"remove", "take a level without versions away", "remove 1", remove_level,
     [](CLI::App& action, SiteOptions& options) {
       action.add_option("NAME", options.level.name, "its name")->required();
       add_who(action, options);
     }},
}};

}  // namespace

std::string unknown_lift_levels(const site::Site& site) {
  const auto levels = site.levels();
  std::string unknown;
  for (const site::Zone& zone : site.zones().zones) {
    for (const std::string& name : zone.levels) {
      if (std::any_of(levels.begin(), levels.end(),
                      [&](const site::Level& level) { return level.name == name; })) {
        continue;
      }
      unknown += (unknown.empty() ? "" : "; ") + ("lift " + zone.name) + " serves level '" + name +
                 "', which the site has not";
    }
  }
  return unknown;
}

void add_level_actions(CLI::App& levels, SiteOptions& options) {
  add_actions(levels, kLevelActions, options);
}

void run_level_action(const SiteOptions& options, VerbContext& context) {
  run_chosen(kLevelActions, options, context);
}

}  // namespace strata::tools
