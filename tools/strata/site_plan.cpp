// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/site_plan.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "components/log/map_file.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/site/active_maps.hpp"
#include "components/site/floor_plan.hpp"
#include "core/base/error.hpp"
#include "core/plan/plan_map.hpp"
#include "core/plan/plan_registration.hpp"
#include "tools/pipeline/cost.hpp"
#include "tools/report/image.hpp"
#include "tools/site/plan_picture.hpp"
#include "tools/strata/plan_words.hpp"
#include "tools/strata/result_directory.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using nlohmann::json;

constexpr double kMapCell_m = 0.05;

void set_plan(const SiteOptions& options, VerbContext& context) {
  const PlanOptions& wanted = options.plan;
  site::Site site = open_site(options, context);
  if (site.has_plan()) {
    throw InputError(options.folder, "has a plan already, which does not move by itself",
                     "take it away first: `strata site plan " + options.folder + " remove`");
  }
  site::FloorPlan plan;
  plan.drawing = site::read_drawing(wanted.file, scale_of(wanted));
  plan::PlanConfig config;
  config.keeps_scale = wanted.keeps_scale;
  if (!wanted.near.empty()) config.near = guessed_place(wanted.near);
  if (const auto active = site.active()) {
    const memory::Store store = maps::open_for_reading(site.maps_of(*active));
    const plan::PlanRegistration found =
        plan::register_plan(plan.drawing.lines, store.load_reflection_grid("filtered"),
                            store.load_surfaces("filtered"), config);
    require_one_place(found, wanted.file);
    plan.fit = found.best;
    plan.site_from_plan = found.best.site_from_plan;
    plan.version = *active;
  } else if (!site.versions().empty() || config.near) {
    throw InputError(options.folder, "has no active version that a plan could lie on",
                     site.versions().empty() ? "leave --near out: its frame becomes the plan's"
                                             : "activate one with `strata site activate`");
  }
  plan.placed = actor(options);
  site.set_plan(plan, plan.placed);
  answer(options, context, words_of(plan), to_json(plan));
}

site::FloorPlan plan_of(const SiteOptions& options, VerbContext& context) {
  auto plan = open_site(options, context).plan();
  if (!plan) {
    throw InputError(options.folder, "has no plan", "`strata site plan SITE set` takes one");
  }
  return *std::move(plan);
}

void show_plan(const SiteOptions& options, VerbContext& context) {
  const site::FloorPlan plan = plan_of(options, context);
  answer(options, context,
         words_of(plan) + "\n  set by " + plan.placed.by + ", " +
             site::utc_text(plan.placed.at_ns) + "; SHA-256 " + plan.drawing.sha256,
         to_json(plan));
}

void remove_plan(const SiteOptions& options, VerbContext& context) {
  open_site(options, context).remove_plan(actor(options));
  answer(options, context, "has no plan now", json(nullptr));
}

void write_map(const SiteOptions& options, VerbContext& context) {
  const pipeline::CostMeter meter;
  const site::FloorPlan plan = plan_of(options, context);
  ResultDirectory out(options.out, "maps", context);
  slam::SlamResult grids;
  grids.filtered = plan::map_of_plan(plan.drawing.lines, plan.site_from_plan, kMapCell_m);
  grids.occupancy = grids.filtered;
  maps::write_grid_maps(out.path(), grids);
  log::write_map(out.path() / "plan.yaml", grids.filtered, {.image = log::MapImageFormat::kPng});
  const auto cost = meter.read();
  maps::write_summary(out.path(), plan.drawing.name, {cost.wall_s, cost.cpu_s, cost.peak_rss_mb});
  out.commit();
  answer(options, context,
         "wrote maps of " + plan.drawing.name + " to " + options.out +
             "; localize in them with --model filtered --set sensor_model=likelihood_field "
             "--set localizer.global_search.watch.is_used=false",
         {{"maps", options.out}, {"yaml", (fs::path(options.out) / "plan.yaml").string()}});
}

void draw_plan(const SiteOptions& options, VerbContext& context) {
  const site::Site site = open_site(options, context);
  const site::FloorPlan plan = plan_of(options, context);
  const ReflectionGrid map =
      site.active()
          ? maps::open_for_reading(site.maps_of(*site.active())).load_reflection_grid("filtered")
          : make_reflection_grid(kMapCell_m, {});
  report::write_file(options.plan.file, report::encode_png(site::draw_plan(
                                            plan.drawing.lines, plan.site_from_plan, map)));
  answer(options, context, "drew " + plan.drawing.name + " in " + options.plan.file, to_json(plan));
}

void add_set(CLI::App& action, SiteOptions& options) {
  PlanOptions& plan = options.plan;
  action
      .add_option("FILE", plan.file,
                  "PNG, PGM or BMP with walls dark on light, or a map_server YAML")
      ->required();
  action.add_option("--metres-per-pixel", plan.metres_per_pixel, "of a picture: its scale");
  action.add_option("--between", plan.between,
                    "... or two points of it, X0,Y0,X1,Y1 in pixels (with --metres)");
  action.add_option("--metres", plan.metres, "how far the two points are apart");
  action.add_option("--near", plan.near,
                    "x,y,degrees of its lower left corner in the site's frame, to about 3 m and 30 "
                    "degrees, where it fits in several places");
  action.add_flag("--keep-scale", plan.keeps_scale,
                  "its scale holds; else up to 2% are found by the map");
  action.add_option("--dark", plan.dark, "pixels darker than this, of 1, are drawn")
      ->check(CLI::Range(0.01, 0.99))
      ->capture_default_str();
  action.add_flag("--inverted", plan.is_inverted, "light lines on dark ground");
  add_who(action, options);
}

constexpr std::array<SiteAction, 5> kPlanActions{{
    {"set", "find where a floor plan lies on the active map, and keep it",
     "set office.png --metres-per-pixel 0.02", set_plan, add_set},
    {"show", "where it lies, and how well it fits", "show --json", show_plan,
     [](CLI::App&, SiteOptions&) {}},
    {"remove", "take it away", "remove", remove_plan, add_who},
    {"map", "write maps of the plan alone, to localize in before there are others",
     "map --out plan-maps", write_map,
     [](CLI::App& action, SiteOptions& options) {
       action
           .add_option("--out", options.out,
                       "folder of maps; plan.yaml and plan.png in it are for map_server")
           ->required();
     }},
    {"draw", "the plan over the map of the active version", "draw plan.png", draw_plan,
     [](CLI::App& action, SiteOptions& options) {
       action.add_option("FILE", options.plan.file, "PNG file to be written")->required();
     }},
}};

}  // namespace

void add_plan_actions(CLI::App& plan, SiteOptions& options) {
  add_actions(plan, kPlanActions, options);
}

void run_plan_action(const SiteOptions& options, VerbContext& context) {
  run_chosen(kPlanActions, options, context);
}

}  // namespace strata::tools
