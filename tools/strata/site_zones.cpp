// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/site_zones.hpp"

#include <array>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <optional>
#include <utility>

#include "components/log/map_file.hpp"
#include "components/log/text.hpp"
#include "components/log/whole_file.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/site/active_maps.hpp"
#include "components/site/zone_masks.hpp"
#include "core/base/error.hpp"
#include "tools/report/map_picture.hpp"
#include "tools/site/often_changing.hpp"
#include "tools/site/zone_picture.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/site_text.hpp"
#include "tools/strata/warning.hpp"
#include "tools/strata/words.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using nlohmann::json;

void list(const SiteOptions& options, VerbContext& context, const site::Zones& zones,
          const std::string& what) {
  json all = json::array();
  std::string text = what.empty() ? counted(zones.zones.size(), "zone") : what;
  for (const site::Zone& zone : zones.zones) {
    all.push_back(json_of(zone));
    if (what.empty()) text += "\n  " + zone.name + ": " + words_of(zone);
  }
  answer(options, context, text, all);
}

/// What is localized in, or without an active version nothing: then masks have cells of 0.05 m.
ReflectionGrid map_of(const site::Site& site) {
  if (!site.active()) return make_reflection_grid(0.05, {});
  return maps::open_for_reading(site::real_maps(site.folder())).load_reflection_grid("filtered");
}

/// warn_of() tells of maps that cannot be read.
ReflectionGrid map_or_none(const site::Site& site) try {
  return map_of(site);
} catch (const InputError&) {
  return make_reflection_grid(0.05, {});
}

/// Of zones that no mask will have.
void warn_of(const site::Site& site, const site::Zones& zones, VerbContext& context) try {
  const ReflectionGrid map = map_of(site);
  warn(context, site::narrow_zones(zones, map.resolution_m(), site::mask_rect(zones, map)));
} catch (const InputError& error) {
  warn(context, error.what());
}

/// Throws where no robot would be told of them.
void require_useful(const site::Site& site, const site::Zones& zones) {
  std::error_code error;
  const bool is_level = fs::exists(site.folder() / site::kLevelFile, error);
  const bool is_building = !site.levels().empty();
  for (const site::Zone& zone : zones.zones) {
    const bool is_lift = zone.kind == site::ZoneKind::kLift;
    if (is_building ? is_lift : !(is_level && is_lift)) continue;
    throw InputError(site.zones_file().string() + ": zone '" + zone.name + "'",
                     std::string("is of kind ") + site::name_of(zone.kind) + ", which a " +
                         (is_building ? "building" : "level") + " has none of",
                     is_building ? "add it to a level, `strata site zones SITE/levels/NAME add`"
                                 : "add it to the building");
  }
  site::require_masks(zones, map_or_none(site));
}

void list_zones(const SiteOptions& options, VerbContext& context) {
  list(options, context, open_site(options, context).zones(), "");
}

void set_zones(const SiteOptions& options, VerbContext& context) {
  site::Site site = open_site(options, context);
  const site::Zones wanted = site::read_zones(options.zone.file);
  const site::Zones now = site.change_zones(
      [&](site::Zones& zones) {
        zones = wanted;
        require_useful(site, zones);
      },
      actor(options), "set from " + options.zone.file, true);
  warn_of(site, now, context);
  list(options, context, now, "has " + counted(now.zones.size(), "zone") + " now");
}

void add_zones(const SiteOptions& options, VerbContext& context) {
  site::Site site = open_site(options, context);
  const site::Zones more = site::read_zones(options.zone.file);
  const site::Zones now = site.change_zones(
      [&](site::Zones& zones) {
        site::add(zones, more, options.zone.file);
        require_useful(site, zones);
      },
      actor(options), "added " + counted(more.zones.size(), "zone") + " from " + options.zone.file);
  warn_of(site, now, context);
  list(options, context, now, "has " + counted(now.zones.size(), "zone") + " now");
}

void remove_zone(const SiteOptions& options, VerbContext& context) {
  site::Site site = open_site(options, context);
  const site::Zones now = site.change_zones(
      [&](site::Zones& zones) {
        site::remove(zones, options.zone.name, site.zones_file().string());
      },
      actor(options), "removed " + options.zone.name);
  list(options, context, now, "has " + counted(now.zones.size(), "zone") + " now");
}

void write_text(const fs::path& path, const std::string& text) {
  log::WholeFile file(path);
  file.stream() << text;
  file.commit();
}

void export_zones(const SiteOptions& options, VerbContext& context) {
  const site::Site site = open_site(options, context);
  const site::Zones zones = site.zones();
  write_text(options.zone.file, site::to_text(zones));
  list(options, context, zones,
       "wrote " + counted(zones.zones.size(), "zone") + " to " + options.zone.file);
}

/// The parameters of nav2's costmap_filter_info_server, and of the map_server of the mask.
std::string nav2_parameters(const site::ZoneMask& mask, const std::string& kind,
                            const std::string& frame) {
  const auto number = [](float value) {
    const std::string text = log::format_number(value);
    return text.find('.') == std::string::npos ? text + ".0" : text;  // nav2 wants a double
  };
  const std::string topic = "/" + kind + "_mask";
  return "costmap_filter_info_server:\n  ros__parameters:\n    type: " +
         std::to_string(mask.meaning.type) + "\n    filter_info_topic: " + topic +
         "_info\n    mask_topic: " + topic + "\n    base: " + number(mask.meaning.base) +
         "\n    multiplier: " + number(mask.meaning.multiplier) +
         "\nfilter_mask_server:\n  ros__parameters:\n    yaml_filename: " + kind +
         ".yaml\n    topic_name: " + topic + "\n    frame_id: " + frame + "\n";
}

void write_mask(const SiteOptions& options, VerbContext& context) {
  const site::MaskKind kind = site::mask_kind(options.zone.kind);
  const site::Site site = open_site(options, context);
  ResultDirectory out(options.out, "a mask", context);
  const site::Zones zones = site.zones();
  const ReflectionGrid map = map_of(site);
  const site::ZoneMask mask = site::mask_of(zones, kind, map, site::mask_rect(zones, map, kind),
                                            {options.zone.outside_cost});
  const std::string name = site::name_of(kind);
  log::write_map(out.path() / (name + ".yaml"), mask.values, {.mode = log::MapMode::kRaw});
  write_text(out.path() / "nav2_params.yaml", nav2_parameters(mask, name, site.decisions().frame));
  out.commit();
  std::size_t cells = 0;
  for (const float value : mask.values.values()) {
    if (is_known(value) && value > 0.0F) ++cells;
  }
  answer(options, context,
         "wrote a mask of " + counted(cells, "cell") + " above 0 to " +
             (fs::path(options.out) / (name + ".yaml")).string(),
         {{"kind", name},
          {"type", mask.meaning.type},
          {"base", mask.meaning.base},
          {"multiplier", mask.meaning.multiplier},
          {"cells", cells}});
}

void import_mask(const SiteOptions& options, VerbContext& context) {
  const site::MaskKind kind = site::mask_kind(options.zone.kind);
  site::Site site = open_site(options, context);
  site::FilterMeaning meaning = site::usual_meaning(kind);
  if (options.zone.base) meaning.base = static_cast<float>(*options.zone.base);
  if (options.zone.multiplier) meaning.multiplier = static_cast<float>(*options.zone.multiplier);
  const std::string name =
      options.zone.name.empty() ? fs::path(options.zone.file).stem().string() : options.zone.name;
  const site::Zones more = site::zones_of_mask(log::read_map(options.zone.file), kind, meaning,
                                               name, site.decisions().frame, options.zone.file);
  const site::Zones now = site.change_zones(
      [&](site::Zones& zones) {
        site::add(zones, more, options.zone.file);
        require_useful(site, zones);
      },
      actor(options), "took " + counted(more.zones.size(), "zone") + " from " + options.zone.file);
  list(options, context, now,
       "took " + counted(more.zones.size(), "zone") + "; has " + counted(now.zones.size(), "zone") +
           " now");
}

void propose(const SiteOptions& options, VerbContext& context) {
  const site::Site site = open_site(options, context);
  const fs::path maps = site::real_maps(site.folder());
  const patch::PatchMap patches =
      maps::read_maps(maps).patches.value_or(patch::PatchMap{});  // none without sub-maps
  const site::Zones found = site::often_changing(patches, site.decisions().frame);
  if (!options.out.empty()) write_text(options.out, site::to_text(found));
  if (options.json) return answer(options, context, "", json(found.document));
  list(options, context, found, "");
}

void draw_zones(const SiteOptions& options, VerbContext& context) {
  const site::Site site = open_site(options, context);
  const site::Zones zones = site.zones();
  const ReflectionGrid map = map_of(site);
  const CellRect shown = report::known_rect(map);
  const CellRect rect = site::mask_rect(zones, map.cropped(shown)).inflated(10);
  report::write_file(options.zone.file, report::encode_png(site::draw_zones(zones, map, rect)));
  list(options, context, zones,
       "drew " + counted(zones.zones.size(), "zone") + " in " + options.zone.file);
}

void add_file(CLI::App& action, SiteOptions& options, const char* what) {
  action.add_option("FILE", options.zone.file, what)->required();
}
void add_kind(CLI::App& action, SiteOptions& options) {
  action
      .add_option("KIND", options.zone.kind,
                  "keepout, preferred, speed (percent), speed_m_s, never_learn, static_only")
      ->required();
}

constexpr std::array<SiteAction, 9> kZoneActions{{
    {"list", "every zone", "list --json", list_zones, [](CLI::App&, SiteOptions&) {}},
    {"set", "take the zones of a file in the place of all there are", "set zones.geojson",
     set_zones,
     [](CLI::App& action, SiteOptions& options) {
       add_file(action, options, "GeoJSON, in metres of the site's frame");
       add_who(action, options);
     }},
    {"add", "add the zones of a file", "add docks.geojson", add_zones,
     [](CLI::App& action, SiteOptions& options) {
       add_file(action, options, "GeoJSON, in metres of the site's frame");
       add_who(action, options);
     }},
    {"remove", "take one zone away", "remove 'dock 3'", remove_zone,
     [](CLI::App& action, SiteOptions& options) {
       action.add_option("NAME", options.zone.name, "its name")->required();
       add_who(action, options);
     }},
    {"export", "write the zones to a file", "export zones.geojson", export_zones,
     [](CLI::App& action, SiteOptions& options) { add_file(action, options, "to be written"); }},
    {"mask", "write the zones of a kind as a mask for nav2", "mask keepout --out mask", write_mask,
     [](CLI::App& action, SiteOptions& options) {
       add_kind(action, options);
       action
           .add_option("--out", options.out,
                       "folder for the mask as map_server has it, and nav2_params.yaml with what "
                       "CostmapFilterInfo says of it")
           ->required();
       action
           .add_option("--outside-cost", options.zone.outside_cost,
                       "preferred: what lies outside costs so many percent")
           ->check(CLI::Range(1.0, 99.0))
           ->capture_default_str();
     }},
    {"import", "add the zones of a mask for nav2", "import keepout keepout_mask.yaml", import_mask,
     [](CLI::App& action, SiteOptions& options) {
       add_kind(action, options);
       add_file(action, options, "the mask's map_server YAML");
       action.add_option("--name", options.zone.name, "of the zone; else the file's");
       action.add_option("--base", options.zone.base,
                         "as the mask's CostmapFilterInfo; by default as `mask` writes it");
       action.add_option("--multiplier", options.zone.multiplier, "the same");
       add_who(action, options);
     }},
    {"propose", "places that change, of the active version, as zones to look at",
     "propose --out changing.geojson", propose,
     [](CLI::App& action, SiteOptions& options) {
       action.add_option("--out", options.out, "GeoJSON file to be written");
     }},
    {"draw", "the zones over the map of the active version", "draw zones.png", draw_zones,
     [](CLI::App& action, SiteOptions& options) {
       add_file(action, options, "PNG file to be written");
     }},
}};

}  // namespace

void add_zone_actions(CLI::App& zones, SiteOptions& options) {
  add_actions(zones, kZoneActions, options);
}

void run_zone_action(const SiteOptions& options, VerbContext& context) {
  run_chosen(kZoneActions, options, context);
}

}  // namespace strata::tools
