// SPDX-License-Identifier: Apache-2.0
/// `strata volume LOG3D --out DIR`: a static 3-D map.
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "components/settings/settings.hpp"
#include "tools/pipeline/volume.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"

namespace strata::tools {
namespace {

struct Options {
  std::string log;
  std::string out;
  std::optional<double> resolution_m;
  std::optional<double> max_range_m;
  bool no_filter = false;
  std::vector<std::string> slices;
};

void note_skipped(const log::CloudReport& report, VerbContext& context) {
  if (report.bad_lines > 0) {
    context.note("warning: " + std::to_string(report.bad_lines) +
                 " places could not be read, the first: " + report.first_bad);
  }
  if (report.clouds_without_pose > 0) {
    context.note("warning: " + std::to_string(report.clouds_without_pose) +
                 " clouds without a pose were left out");
  }
}

void run_volume(const Options& options, VerbContext& context) {
  const pipeline::CostMeter meter;
  auto config = settings::read_config<pipeline::VolumeJobConfig>(load_config(context.options),
                                                                 config_place(context.options));
  if (options.resolution_m) config.map.resolution_m = *options.resolution_m;
  if (options.max_range_m) config.map.max_range_m = *options.max_range_m;
  std::vector<pipeline::SliceRange> slices;
  for (const std::string& text : options.slices) slices.push_back(pipeline::parse_slice(text));
  const pipeline::VolumeResult result = pipeline::make_volume(
      options.log, config, !options.no_filter, context.options.threads, context.progress());
  note_skipped(result.report, context);
  OutputDirectory out(options.out, context.staged());
  const nlohmann::json summary =
      pipeline::write_volume(out.path(), options.log, result, slices, meter.read());
  out.commit();
  if (context.options.quiet) return;
  std::cout << summary["clouds"] << " clouds, " << summary["points"]["total"] << " points ("
            << summary["points"]["dynamic"] << " taken for moving): " << summary["nodes"]
            << " nodes, " << summary["voxels"]["occupied"] << " voxels occupied; map in "
            << options.out << '\n';
}

}  // namespace

void add_volume(CLI::App& app, VerbContext& context) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(app, context, "volume", "a 3-D map of what stands still (OctoMap)",
                            "strata volume hallway.log.gz --out hallway --resolution 0.05",
                            [options, &context] { run_volume(*options, context); });
  verb->add_option("LOG3D", options->log,
                   "OctoMap log (plain or gzipped), scan graph, or a bag with PointCloud2 and tf")
      ->required();
  verb->add_option("--out", options->out,
                   "folder for map.bt, map.ot, slices, pictures, report.html, summary.json")
      ->required();
  verb->add_option("--resolution", options->resolution_m, "edge of a voxel [m]; 0.1");
  verb->add_option("--max-range", options->max_range_m, "points further away only free space [m]");
  verb->add_flag("--no-filter", options->no_filter, "take every point for static");
  verb->add_option("--slice", options->slices,
                   "FROM:TO, heights in m: a map_server map of what lies between; may be repeated");
}

}  // namespace strata::tools
