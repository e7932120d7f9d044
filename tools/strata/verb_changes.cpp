// SPDX-License-Identifier: Apache-2.0
/// `strata changes MAPS`: what has changed lately, as the levels of a timescale memory tell it.
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "components/log/json_text.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/settings/settings.hpp"
#include "core/base/error.hpp"
#include "memory/decoding/decoding_config.hpp"
#include "memory/store/store.hpp"
#include "tools/pipeline/level_changes.hpp"
#include "tools/report/drawings.hpp"
#include "tools/report/image.hpp"
#include "tools/strata/positive.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"
#include "tools/strata/warning.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {
namespace {

struct ChangesOptions {
  std::string maps;
  std::string out;
  pipeline::LevelChangesTask task;
  std::vector<double> ends_m;
  bool json = false;
};

struct ChangesConfig {
  memory::DecodingConfig decoding;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("decoding", c.decoding, "how levels become the scans that are compared");
  }
};

std::filesystem::path store_of(const std::string& maps) {
  if (maps.empty()) throw InputError("MAPS", "is an empty name", "name a folder of maps");
  const std::filesystem::path path(maps);
  std::error_code error;  // of a name that no file can have: the store says it
  return std::filesystem::is_directory(path, error) ? path / maps::kStoreFile : path;
}

void print_places(const pipeline::LevelChanges& changes) {
  std::printf("%s between '%s' and '%s'\n",
              counted(changes.places.size(), "place differs", "places differ").c_str(),
              changes.before.c_str(), changes.now.c_str());
  for (const memory::ChangedPlace& place : changes.places) {
    const Eigen::Vector2d size = place.max_m - place.min_m;
    std::printf("  %s at (%.2f, %.2f), %.2f m x %.2f m\n",
                place.kind == memory::ChangeKind::kAppeared ? "appeared" : "vanished",
                place.center_m().x(), place.center_m().y(), size.x(), size.y());
  }
}

void print_paths(const pipeline::LevelChanges& changes, const pipeline::LevelChangesTask& task) {
  for (std::size_t i = 0; i < changes.paths.size(); ++i) {
    const auto& [from, to] = task.paths[i];
    std::printf("from (%.2f, %.2f) to (%.2f, %.2f)\n", from.x(), from.y(), to.x(), to.y());
    for (const pipeline::LevelPath& path : changes.paths[i]) {
      if (!path.path) {
        std::printf("  %s: no way\n", path.level.c_str());
      } else if (!path.frechet_m) {
        std::printf("  %s: %.2f m\n", path.level.c_str(), pipeline::length_m(*path.path));
      } else {
        std::printf("  %s: %.2f m, at most %.2f m from that of '%s'\n", path.level.c_str(),
                    pipeline::length_m(*path.path), *path.frechet_m, changes.before.c_str());
      }
    }
  }
}

void run(ChangesOptions options, VerbContext& context) {
  const auto config = read_config<ChangesConfig>(context);
  if (options.ends_m.size() % 4 != 0) {
    throw InputError("--path", "has " + std::to_string(options.ends_m.size()) + " numbers, not 4",
                     "give x0,y0,x1,y1, in metres");
  }
  std::optional<ResultDirectory> out;
  if (!options.out.empty()) out.emplace(options.out, "changes", context);
  for (std::size_t i = 0; i < options.ends_m.size(); i += 4) {
    const double* p = &options.ends_m[i];
    options.task.paths.push_back({{p[0], p[1]}, {p[2], p[3]}});
  }
  const memory::Store store(store_of(options.maps), {.read_only = true, .check = false});
  // Nodes are read one after the other: the memory may be larger than what fits in RAM.
  const memory::TimescaleMemory memory = store.open_timescale();
  const auto map = memory.decode(config.decoding);
  const pipeline::LevelChanges changes = pipeline::level_changes(memory, *map, options.task);
  const auto text = to_json(changes, options.task);
  if (out) {
    report::write_file(out->path() / "changes.json", log::json_text(text));
    report::Drawings drawings;
    pipeline::draw_level_changes(out->path(), *map, changes, &drawings);
    out->commit();
    warn(context, drawings.what_is_missing());
  }
  if (options.json) {
    std::cout << log::json_text(text);
  } else if (!context.options.quiet) {
    print_places(changes);
    print_paths(changes, options.task);
    std::fflush(stdout);
  }
}

}  // namespace

void add_changes(CLI::App& app, VerbContext& context) {
  const auto [verb, options] = add_verb<ChangesOptions>(
      app, context, "changes", "what has changed lately, by the levels of a memory",
      "strata changes maps --before long --now short --path 1,6,18,6 --out changes", run);
  verb->add_option("MAPS", options->maps, "folder of maps, or a strata.db")->required();
  verb->add_option("--before", options->task.before,
                   "level that still shows the old state; the one that forgets slowest");
  verb->add_option("--now", options->task.now,
                   "level that shows the new state; the one that forgets fastest");
  verb->add_option("--path", options->ends_m,
                   "x0,y0,x1,y1: the shortest path between two points on each level's map, and how "
                   "it differs; may be repeated")
      ->delimiter(',')
      ->expected(4)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_option("--radius", options->task.robot_radius_m, "of the robot that would drive it, m")
      ->check(positive())
      ->capture_default_str();
  verb->add_option("--out", options->out, "folder for changes.json and pictures");
  add_force(*verb, context);
  verb->add_flag("--json", options->json, "as JSON on stdout");
}

}  // namespace strata::tools
