// SPDX-License-Identifier: Apache-2.0
/// `strata volume LOG3D --out DIR`: a static 3-D map.
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "components/settings/settings.hpp"
#include "core/base/error.hpp"
#include "tools/pipeline/volume_output.hpp"
#include "tools/report/drawings.hpp"
#include "tools/report/plot.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"
#include "tools/strata/warning.hpp"

namespace strata::tools {
namespace {

struct VolumeOptions {
  std::string log;
  std::string out;
  std::optional<double> resolution_m;
  std::optional<double> max_range_m;
  bool no_filter = false;
  bool remember = false;
  std::string poses;
  std::string moving;
  std::vector<std::string> slices;
};

pipeline::MovingKind parse_moving(const std::string& text) {
  for (const auto& [kind, name] : EnumNames<pipeline::MovingKind>::values) {
    if (text == name) return kind;
  }
  throw InputError("--moving " + text, "is unknown",
                   "choose among auto, boxes, voxels, both, none");
}

void note_skipped(const pipeline::VolumeResult& result, VerbContext& context) {
  const clouds::CloudReport& report = result.report;
  for (const std::string& warning : result.warnings) context.note("warning: " + warning);
  if (report.bad_lines > 0) {
    context.note("warning: " + std::to_string(report.bad_lines) +
                 " places could not be read, the first: " + report.first_bad);
  }
  if (report.clouds_without_pose > 0) {
    context.note("warning: " + std::to_string(report.clouds_without_pose) +
                 " clouds without a pose were left out");
  }
  if (result.counts.not_finite > 0) {
    context.note("note: " + std::to_string(result.counts.not_finite) +
                 " points that are no numbers were left out");
  }
  const std::size_t images = result.images.unreadable + result.images.without_pose;
  if (images > 0) {
    context.note("warning: " + std::to_string(images) +
                 " images were left out, the first: " + result.images.first_bad);
  }
}

void run_volume(const VolumeOptions& options, VerbContext& context) {
  const pipeline::CostMeter meter;
  auto config = read_config<pipeline::VolumeJobConfig>(context);
  if (options.resolution_m) config.map.resolution_m = *options.resolution_m;
  if (!options.moving.empty()) config.moving = parse_moving(options.moving);
  if (options.no_filter) config.moving = pipeline::MovingKind::kNone;
  config.remember = config.remember || options.remember;
  if (options.max_range_m) config.map.max_range_m = *options.max_range_m;
  std::vector<pipeline::SliceRange> slices;
  for (const std::string& text : options.slices) slices.push_back(pipeline::parse_slice(text));
  ResultDirectory out(options.out, "volume", context);
  const pipeline::VolumeResult result = pipeline::make_volume(
      options.log, options.poses, config, context.options.threads, context.progress());
  note_skipped(result, context);
  report::Drawings drawings;
  const nlohmann::json summary =
      pipeline::write_volume(out.path(), options.log, result, slices, meter.read(), drawings);
  out.commit();
  warn(context, drawings.what_is_missing());
  if (context.options.quiet) return;
  std::cout << summary["clouds"] << " clouds, " << summary["points"]["total"] << " points ("
            << summary["points"]["dynamic"] << " taken for moving): " << summary["nodes"]
            << " nodes, " << summary["voxels"]["occupied"] << " voxels occupied; map in "
            << options.out << '\n';
  if (!result.score) return;
  const auto percent = [](double share) { return report::fixed(100.0 * share, 1) + "%"; };
  std::cout << "truth: " << percent(result.score->gone()) << " of the " << result.score->moving_made
            << " voxels made by what moves gone, " << percent(result.score->lost()) << " of the "
            << result.score->static_voxels << " static ones lost\n";
}

}  // namespace

void add_volume(CLI::App& app, VerbContext& context) {
  const auto [verb, options] = add_verb<VolumeOptions>(
      app, context, "volume", "a 3-D map of what stands still (OctoMap)",
      "strata volume hallway.log.gz --out hallway --resolution 0.05", run_volume);
  verb->add_option(
          "LOG3D", options->log,
          "OctoMap log (plain or gzipped), scan graph, a bag with PointCloud2, or a .bt or .ot "
          "file")
      ->required();
  verb->add_option("--out", options->out,
                   "folder for map.bt, map.ot, map_color.ot, slices, pictures, report.html, "
                   "summary.json")
      ->required();
  add_force(*verb, context);
  verb->add_option("--resolution", options->resolution_m, "edge of a voxel [m]; 0.1");
  verb->add_option("--max-range", options->max_range_m, "points further away only free space [m]");
  verb->add_option("--poses", options->poses,
                   "where the robot was (TUM or t x y theta), instead of tf or SLAM over /scan");
  verb->add_option("--moving", options->moving,
                   "how points on what moves are told: auto, boxes, voxels, both, none");
  verb->add_flag("--remember", options->remember,
                 "keep short, mid and long levels of every voxel; writes changes.json");
  verb->add_flag("--no-filter", options->no_filter, "take every point for static");
  verb->add_option("--slice", options->slices,
                   "FROM:TO, heights in m: a map_server map of what lies between; may be repeated");
}

}  // namespace strata::tools
