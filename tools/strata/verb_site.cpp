// SPDX-License-Identifier: Apache-2.0
/// `strata site ACTION DIR`: versions of a building's maps.
#include <array>
#include <cstdint>
#include <iostream>
#include <memory>
#include <string>

#include "components/site/site.hpp"
#include "core/base/error.hpp"
#include "tools/report/plot.hpp"
#include "tools/strata/site_actions.hpp"
#include "tools/strata/site_levels.hpp"
#include "tools/strata/site_plan.hpp"
#include "tools/strata/site_text.hpp"
#include "tools/strata/site_zones.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {
namespace {

void init(const SiteOptions& options, VerbContext& context) {
  const site::Site site =
      site::Site::create(options.folder, options.id, options.frame, actor(options));
  answer(
      options, context,
      "made site " + options.id + "; add maps with `strata site add " + options.folder + " MAPS`",
      json_of_site(site));
}

void add(const SiteOptions& options, VerbContext& context) {
  site::Site site = open_site(options, context);
  const site::Site::Added added = site.add(options.maps, actor(options), options.note);
  nlohmann::json as_json = json_of(added.status);
  as_json["is_new"] = added.is_new;
  answer(options, context,
         added.is_new ? "added version " + name_of(added.status) + " as a candidate"
                      : "these maps are version " + name_of(added.status) + " already, " +
                            site::name_of(added.status.state),
         as_json);
}

void status(const SiteOptions& options, VerbContext& context) {
  const site::Site site = open_site(options, context);
  if (options.json) {
    std::cout << json_of_site(site).dump(2) << "\n";
  } else if (!context.options.quiet) {
    print_site(site);
    print_diary(site, options.diary);
  }
}

void list(const SiteOptions& options, VerbContext& context) {
  const site::Site site = open_site(options, context);
  if (options.json) {
    std::cout << json_of_versions(site).dump(2) << "\n";
  } else if (!context.options.quiet) {
    print_versions(site);
  }
}

void switched(const SiteOptions& options, VerbContext& context, const site::Site& site,
              const site::Switch& made) {
  const site::VersionStatus now = site.find(made.to);
  nlohmann::json as_json = json_of(now);
  as_json["from"] = made.from.empty() ? nlohmann::json(nullptr) : nlohmann::json(made.from);
  answer(options, context,
         made.from == made.to ? "version " + name_of(now) + " is active already"
                              : "version " + name_of(now) + " is active",
         as_json);
}

void activate(const SiteOptions& options, VerbContext& context) {
  site::Site site = open_site(options, context);
  const std::string hash = site.find(options.version).version.hash;
  switched(options, context, site, site.activate(hash, actor(options)));
}

void rollback(const SiteOptions& options, VerbContext& context) {
  site::Site site = open_site(options, context);
  switched(options, context, site, site.rollback(actor(options)));
}

void keep(const SiteOptions& options, VerbContext& context) {
  site::Site site = open_site(options, context);
  pipeline::RunsInput input;
  input.logs = {options.log};
  if (!options.truth.empty()) input.truths = {options.truth};
  (void)pipeline::read_runs(input, context.progress());  // the gate must be able to read it
  const auto gone = site.keep(options.log, options.truth,
                              static_cast<std::uint64_t>(options.max_mb * 1e6), actor(options));
  nlohmann::json as_json = nlohmann::json::array();
  std::uint64_t bytes = 0;
  const auto kept = site.recordings();
  for (const site::KeptRecording& one : kept) {
    bytes += one.bytes;
    as_json.push_back({{"log", one.log.string()},
                       {"truth", one.truth.empty() ? nlohmann::json(nullptr)
                                                   : nlohmann::json(one.truth.string())},
                       {"bytes", one.bytes}});
  }
  answer(options, context,
         "keeps " + counted(kept.size(), "recording") + " of " +
             report::fixed(static_cast<double>(bytes) / 1e6, 1) + " MB" +
             (gone.empty() ? "" : "; the oldest went: " + counted(gone.size(), "recording")),
         as_json);
}

void collect(const SiteOptions& options, VerbContext& context) {
  site::Site site = open_site(options, context);
  const auto gone = site.remove_rubbish(options.rubbish, actor(options));
  nlohmann::json as_json = nlohmann::json::array();
  std::string names;
  for (const site::VersionStatus& one : gone) {
    as_json.push_back(json_of(one));
    names += (names.empty() ? ": " : ", ") + name_of(one);
  }
  answer(options, context,
         std::string(options.rubbish.dry_run ? "would remove " : "removed ") +
             counted(gone.size(), "version") + names,
         as_json);
}

void add_version(CLI::App& action, SiteOptions& options) {
  action
      .add_option("VERSION", options.version,
                  "its number, the begin of its hash, or active, previous, newest")
      ->required();
}

void add_note(CLI::App& action, SiteOptions& options) {
  action.add_option("--note", options.note, "why, for the diary");
}

constexpr std::array<SiteAction, 16> kActions{{
    {"init", "make a site", "site --id hall-3", init,
     [](CLI::App& action, SiteOptions& options) {
       action.add_option("--id", options.id, "its name, VDA 5050's mapId")->required();
       action.add_option("--frame", options.frame, "frame of its maps")->capture_default_str();
       add_who(action, options);
     }},
    {"add", "copy a folder of maps in, as a candidate", "site maps --note 'after the move'", add,
     [](CLI::App& action, SiteOptions& options) {
       action.add_option("MAPS", options.maps, "folder that `strata learn` or a mapper wrote")
           ->required();
       add_note(action, options);
       add_who(action, options);
     }},
    {"status", "what is active, and what waits", "site --diary 10", status,
     [](CLI::App& action, SiteOptions& options) {
       action.add_option("--diary", options.diary, "so many of the last lines of the diary");
     }},
    {"list", "every version", "site --json", list, [](CLI::App&, SiteOptions&) {}},
    {"diff", "what is another way in the second version", "site active newest --out diff",
     compare_versions,
     [](CLI::App& action, SiteOptions& options) {
       action.add_option("FROM", options.version, "a version, as `activate` takes it")->required();
       action.add_option("TO", options.other, "the later one")->required();
       action.add_option("--out", options.out, "folder for diff.png and diff.geojson");
     }},
    {"check", "whether a version may take the place of the active one",
     "site newest --log monday.clf --log tuesday.clf --out check", check_version,
     [](CLI::App& action, SiteOptions& options) {
       add_version(action, options);
       add_gate_options(action, options);
     }},
    {"approve", "check a version, and say that it may be activated",
     "site newest --log monday.clf --note 'walked through'", approve_version,
     [](CLI::App& action, SiteOptions& options) {
       add_version(action, options);
       add_gate_options(action, options);
       action.add_flag("--unchecked", options.unchecked, "approve it without a check");
       add_note(action, options);
       add_who(action, options);
     }},
    {"take", "add maps, and activate them where the check lets them through: for every night",
     "site maps", take_maps,
     [](CLI::App& action, SiteOptions& options) {
       action.add_option("MAPS", options.maps, "folder that `strata learn` or a mapper wrote")
           ->required();
       add_gate_options(action, options);
       add_note(action, options);
       add_who(action, options);
     }},
    {"merge", "add a version that is the active one, and in a region another one",
     "site 5 --region hall.geojson --out merged", merge_version,
     [](CLI::App& action, SiteOptions& options) {
       add_version(action, options);
       action
           .add_option("--region", options.region, "GeoJSON file of polygons in metres of the maps")
           ->required();
       action.add_flag("--anew", options.anew,
                       "what the active version knows of the region is forgotten: it was rebuilt");
       action.add_option("--out", options.out, "folder for its maps")->required();
       add_note(action, options);
       add_who(action, options);
     }},
    {"keep", "keep a recording that later checks replay", "site monday.clf --max-mb 500", keep,
     [](CLI::App& action, SiteOptions& options) {
       action
           .add_option("LOG", options.log, "CARMEN log, rosbag2 folder, .db3, .mcap or ROS 1 .bag")
           ->required();
       action.add_option("--truth", options.truth,
                         "its true poses, as `strata localize` takes them");
       action
           .add_option("--max-mb", options.max_mb,
                       "all recordings together; the oldest go until they fit")
           ->check(CLI::PositiveNumber)
           ->capture_default_str();
       add_who(action, options);
     }},
    {"activate", "make a version the one that robots localize in", "site 3", activate,
     [](CLI::App& action, SiteOptions& options) {
       add_version(action, options);
       add_who(action, options);
     }},
    {"rollback", "go back to the version that was active before", "site", rollback,
     [](CLI::App& action, SiteOptions& options) { add_who(action, options); }},
    {"gc", "remove versions that nobody needs any more", "site --keep 5 --dry-run", collect,
     [](CLI::App& action, SiteOptions& options) {
       action
           .add_option("--keep", options.rubbish.keep_retired,
                       "so many versions that were active last stay")
           ->capture_default_str();
       action.add_flag("--damaged", options.rubbish.damaged,
                       "also those whose hash does not hold, unless active");
       action.add_flag("--dry-run", options.rubbish.dry_run, "only say what would go");
       add_who(action, options);
     }},
    {"zones", "what people draw over the maps: keepout, speed, preferred, and what may be learned",
     "site list", run_zone_action, add_zone_actions},
    {"plan", "a drawn floor plan, and where it lies on the maps",
     "site set office.png --metres-per-pixel 0.02", run_plan_action, add_plan_actions},
    {"levels", "the levels of a building, each a site of its own", "site add 1 --elevation 3.5",
     run_level_action, add_level_actions},
}};

}  // namespace

void add_site(CLI::App& app, VerbContext& context) {
  auto options = std::make_shared<SiteOptions>();
  CLI::App* verb =
      add_verb(app, context, "site", "versions of a building's maps: approve, activate, take back",
               "strata site init site --id hall-3 && strata site add site maps && "
               "strata site approve site 1 && strata site activate site 1",
               [options, &context, &app] {
                 const CLI::App* chosen = app.get_subcommand("site")->get_subcommands().front();
                 for (const SiteAction& action : kActions) {
                   if (chosen->get_name() == action.name) action.run(*options, context);
                 }
               });
  verb->require_subcommand(1);
  for (const SiteAction& action : kActions) {
    CLI::App* added = verb->add_subcommand(action.name, action.description);
    added->add_option("SITE", options->folder, "its folder")->required();
    action.add_options(*added, *options);
    added->add_flag("--json", options->json, "as JSON on stdout");
    added->footer(std::string("Example:\n  strata site ") + action.name + " " + action.example);
    added->fallthrough();  // the common options are the verb's
  }
}

}  // namespace strata::tools
