// SPDX-License-Identifier: Apache-2.0
/// `strata fleet ACTION URL`: robots of a site share what they learn, through PostgreSQL.
#include <array>
#include <memory>
#include <string>

#include "tools/strata/fleet_actions.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"

namespace strata::tools {
namespace {

struct Action {
  const char* name;
  const char* description;
  const char* example;
  void (*add_options)(CLI::App&, FleetOptions&);
};

void add_site_name(CLI::App& action, FleetOptions& options) {
  action.add_option("--site", options.site, "the site's name, as of `strata site init --id`")
      ->required();
}

void add_folder(CLI::App& action, FleetOptions& options) {
  action.add_option("SITE", options.folder, "folder of the local site")->required();
}

void add_member_options(CLI::App& action, FleetOptions& options, const std::string& what) {
  add_site_name(action, options);
  action.add_option("NAME", options.name, "of the " + what)->required();
  action.add_option("--password-file", options.password_file,
                    "its first line is the password; by default one is made and told");
  action.add_flag("--new-password", options.new_password, "for one that is there already");
}

constexpr std::array<Action, 10> kActions{{
    {"init", "make the tables, and a site in them", "postgresql://admin@server/fleet --site hall-3",
     [](CLI::App& action, FleetOptions& options) {
       add_site_name(action, options);
       action.add_option("--frame", options.frame, "frame of its maps")->capture_default_str();
     }},
    {"add-robot", "let a robot add visits and read released versions",
     "postgresql://admin@server/fleet --site hall-3 robot-1",
     [](CLI::App& action, FleetOptions& options) { add_member_options(action, options, "robot"); }},
    {"add-operator", "let somebody read a site's visits and release versions",
     "postgresql://admin@server/fleet --site hall-3 ada",
     [](CLI::App& action, FleetOptions& options) {
       add_member_options(action, options, "operator");
     }},
    {"release", "give a version of a local site to all robots",
     "postgresql://hall-3.ada@server/fleet site active --note 'after the move'",
     [](CLI::App& action, FleetOptions& options) {
       add_folder(action, options);
       action.add_option("VERSION", options.version, "as `strata site` takes it")->required();
       action.add_option("--note", options.note, "why, for those who pull it");
       action.add_flag("--again", options.again,
                       "also of active, newest and previous: one that was withdrawn, or that "
                       "another one took the place of; robots go back to it");
     }},
    {"withdraw", "give a version to no robot any more",
     "postgresql://hall-3.ada@server/fleet --site hall-3 3f2a9c41d7b8",
     [](CLI::App& action, FleetOptions& options) {
       add_site_name(action, options);
       action.add_option("HASH", options.version, "of the version, or its begin")->required();
     }},
    {"push", "send a robot's own visits that the server does not have",
     "postgresql://hall-3.robot-1@server/fleet maps --site hall-3 --against site",
     [](CLI::App& action, FleetOptions& options) {
       action.add_option("MAPS", options.folder, "folder that `strata learn` wrote")->required();
       add_site_name(action, options);
       action
           .add_option("--spacing", options.spacing_m,
                       "metres: of a visit send a scan every so far, or half a radian, or 10 s; 0: "
                       "every scan, seven times as much as with 0.5")
           ->check(CLI::Range(0.0, 10.0))
           ->capture_default_str();
       CLI::Option* against = action.add_option(
           "--against", options.against,
           "folder of the local site: visits are told relative to its active version, in far "
           "fewer bytes");
       action
           .add_option("--tolerance", options.tolerance_cells,
                       "cells of that map: beams that end so near to where it says end there; 0: "
                       "every beam as it was measured")
           ->check(CLI::Range(0.0, 3.0))
           ->capture_default_str()
           ->needs(against);
     }},
    {"pull", "bring the version that was released last into a local site",
     "postgresql://hall-3.robot-1@server/fleet site --activate",
     [](CLI::App& action, FleetOptions& options) {
       add_folder(action, options);
       action.add_flag("--approve", options.approve, "its release counts as the approval");
       CLI::Option* activate =
           action.add_flag("--activate", options.activate, "approve it, and localize in it");
       action
           .add_option("--keep", options.keep_retired,
                       "with --activate: so many of the versions that were active before stay, and "
                       "the first one")
           ->capture_default_str()
           ->needs(activate);
       action.add_option("--by", options.by, "who does it, for the diary; by default USER@HOST");
     }},
    {"learn", "learn all robots' visits, on top of a local site's active version",
     "postgresql://hall-3.ada@server/fleet site --out maps",
     [](CLI::App& action, FleetOptions& options) {
       add_folder(action, options);
       action.add_option("--out", options.name, "folder for the maps")->required();
       action
           .add_option("--max-contradicted", options.max_contradicted,
                       "share of a visit's scans that may contradict the active version, ...")
           ->check(CLI::Range(0.0, 1.0))
           ->capture_default_str();
       action
           .add_option("--max-above-others", options.max_above_others,
                       "... and by so much more than the other robots': beyond both, the visit is "
                       "left out")
           ->check(CLI::Range(0.0, 1.0))
           ->capture_default_str();
       action.add_flag("--unchecked", options.unchecked, "judge no visit, set no robot aside");
       action
           .add_option("--without", options.without,
                       "a visit that is left out, as ROBOT:NUMBER; may be repeated")
           ->take_all()
           ->allow_extra_args(false);
     }},
    {"set-aside", "learn from a robot's visits no more",
     "postgresql://hall-3.ada@server/fleet --site hall-3 robot-4 --why 'its laser is bent'",
     [](CLI::App& action, FleetOptions& options) {
       add_site_name(action, options);
       action.add_option("ROBOT", options.name, "its name")->required();
       auto* why = action.add_option("--why", options.why, "for those who ask");
       action.add_flag("--undo", options.undo, "learn from them again")->excludes(why);
     }},
    {"status", "robots, visits and versions, as far as who asks may know",
     "postgresql://hall-3.ada@server/fleet --site hall-3 --json", add_site_name},
}};

}  // namespace

void add_fleet(CLI::App& app, VerbContext& context) {
  auto options = std::make_shared<FleetOptions>();
  CLI::App* verb = add_verb(
      app, context, "fleet", "share visits and released maps among robots, through PostgreSQL",
      "strata fleet push postgresql://hall-3.robot-1@server/fleet maps --site hall-3 && "
      "strata fleet pull postgresql://hall-3.robot-1@server/fleet site --activate",
      [options, &context, &app] {
        run_fleet_action(app.get_subcommand("fleet")->get_subcommands().front()->get_name(),
                         *options, context);
      });
  verb->require_subcommand(1);
  for (const Action& action : kActions) {
    CLI::App* added = verb->add_subcommand(action.name, action.description);
    added
        ->add_option("URL", options->url,
                     "of the server, as libpq has it: postgresql://ROLE@HOST/DATABASE"
                     "?sslmode=verify-full; passwords go into ~/.pgpass or PGPASSWORD")
        ->required();
    action.add_options(*added, *options);
    added->add_option("--timeout", options->timeout_s, "seconds that one statement may take")
        ->check(CLI::Range(1, 86400))
        ->capture_default_str();
    added->add_flag("--json", options->json, "as JSON on stdout");
    added->footer(std::string("Example:\n  strata fleet ") + action.name + " " + action.example);
    added->fallthrough();  // the common options are the verb's
  }
}

}  // namespace strata::tools
