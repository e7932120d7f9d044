// SPDX-License-Identifier: Apache-2.0
/// `strata topology LOG --out DIR`: the posterior over topologies, and the map of the likeliest.
#include <iostream>
#include <memory>
#include <string>

#include "components/settings/settings.hpp"
#include "core/base/error.hpp"
#include "tools/pipeline/cost.hpp"
#include "tools/pipeline/topology.hpp"
#include "tools/pipeline/topology_files.hpp"
#include "tools/report/plot.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/run_options.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"
#include "tools/strata/warning.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {
namespace {

/// Places of the truth within this distance are one landmark.
constexpr double kNearM = 1.0;

struct TopologyOptions {
  pipeline::RunsInput input;
  std::string log;
  std::string out;
  std::string landmarks;
  double truth_precision_m = 0.0;
};

void print_agreement(const pipeline::TopologyAgreement& agreement, double precision_m) {
  std::cout << agreement.near_merged << " of " << agreement.near << " pairs of visits within "
            << kNearM - precision_m << " m are merged; " << agreement.between_merged << " of "
            << agreement.between << " less than " << 2.0 * kNearM << " m apart are too ("
            << agreement.between_chained << " are linked by others), " << agreement.far_merged
            << " of " << agreement.far << " further apart";
  if (precision_m > 0.0) {
    std::cout << "; of those between " << kNearM - precision_m << " and " << kNearM + precision_m
              << " m, where the truth cannot tell, " << agreement.unclear_merged << " of "
              << agreement.unclear;
  }
  std::cout << '\n';
}

void run_topology(TopologyOptions options, VerbContext& context) {
  const pipeline::CostMeter meter;
  const auto config = read_config<topology::TopologyMapperConfig>(context);
  ResultDirectory out(options.out, "topology", context);
  std::vector<double> times_s;
  if (!options.landmarks.empty()) times_s = pipeline::read_landmark_times(options.landmarks);
  options.input.logs = {options.log};
  const pipeline::Runs runs = pipeline::read_runs(options.input, context.progress());
  note_reports(context, runs);
  std::optional<std::span<const double>> landmarks;
  if (!options.landmarks.empty()) landmarks = times_s;
  const pipeline::TopologyMap result =
      pipeline::map_topology(runs.observations, runs.poses, landmarks, config, context.options.seed,
                             context.options.threads, context.progress());
  std::optional<pipeline::TopologyAgreement> agreement;
  if (!options.input.truths.empty()) {
    agreement = pipeline::agreement(result, result.posterior.front(), runs.observations,
                                    runs.truths, kNearM, options.truth_precision_m);
  }
  const nlohmann::json json =
      pipeline::write_topology(out.path(), options.log, result, meter.read(), agreement);
  report::Drawings drawings;
  pipeline::write_topology_pictures(out.path(), result, drawings);
  out.commit();
  warn(context, drawings.what_is_missing());
  if (context.options.quiet) return;
  const topology::Hypothesis& best = result.posterior.front();
  const nlohmann::json& update_ms = json["cost"]["update_ms"];
  std::cout << counted(result.visits.size(), "visit") << " of "
            << counted(static_cast<std::size_t>(topology::landmark_count(best.labels)), "landmark")
            << " with probability " << report::fixed(best.probability, 4) << "; "
            << counted(result.posterior.size(), "topology", "topologies") << " in " << options.out
            << "; an update took " << report::fixed(update_ms["median"], 1) << " ms (median), "
            << report::fixed(update_ms["max"], 1) << " ms at most\n";
  if (agreement) print_agreement(*agreement, options.truth_precision_m);
}

}  // namespace

void add_topology(CLI::App& app, VerbContext& context) {
  const auto [verb, options] = add_verb<TopologyOptions>(
      app, context, "topology", "find the topologies that a run may have, with their odds",
      "strata topology office.clf --out topology", run_topology);
  verb->add_option("LOG", options->log, "CARMEN log, rosbag2 folder, .db3, .mcap or ROS 1 .bag")
      ->required();
  verb->add_option("--out", options->out, "folder for the results")->required();
  add_force(*verb, context);
  verb->add_option("--landmarks", options->landmarks,
                   "file of landmark times, seconds from the first scan, one a line; without it "
                   "junctions and rooms are found in the scans");
  verb->add_option("--truth-precision", options->truth_precision_m,
                   "how well the truth tells the distance of two places [m]: pairs as near to 1 m "
                   "as that are counted apart")
      ->check(CLI::Range(0.0, 0.5 * kNearM));
  add_run_options(*verb, options->input);
}

}  // namespace strata::tools
