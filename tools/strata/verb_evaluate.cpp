// SPDX-License-Identifier: Apache-2.0
/// `strata evaluate TRAJECTORY`: errors against the truth or against relations.
#include <cstdio>
#include <iostream>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "components/log/json_text.hpp"
#include "components/log/log_reader.hpp"
#include "components/log/relations_file.hpp"
#include "components/log/trajectory_file.hpp"
#include "core/base/error.hpp"
#include "tools/evaluate/trajectory_error.hpp"
#include "tools/strata/positive.hpp"
#include "tools/strata/verbs.hpp"

namespace strata::tools {
namespace {

using Json = nlohmann::ordered_json;

struct EvaluateOptions {
  std::string trajectory;
  std::string truth;
  std::string relations;
  std::string against;
  std::string frame = "robot";
  std::string log;
  std::vector<double> mounting;
  double truth_offset_s = 0.0;
  double delta_s = 1.0;
  bool json = false;
};

Json to_json(const ErrorSummary& error) {
  return {{"mean", error.mean},     {"mean_squared", error.mean_squared},
          {"stddev", error.stddev}, {"median", error.median},
          {"p95", error.p95},       {"max", error.max},
          {"rmse", error.rmse}};
}

Json to_json(const TrajectoryErrors& errors) {
  return {{"matched", errors.matched},
          {"unmatched", errors.unmatched},
          {"error_m", to_json(errors.translation_m)},
          {"error_rad", to_json(errors.rotation_rad)}};
}

void require_matches(const TrajectoryErrors& errors, const std::string& file) {
  if (errors.matched > 0) return;
  throw InputError(file, "no pose of the trajectory is near it in time",
                   "check the stamps, or shift them with --truth-offset");
}

/// --frame laser: the trajectory's robot poses become the laser's.
void move_to_laser(std::vector<log::StampedPose>& poses, const EvaluateOptions& options) {
  Pose2 mounting;
  if (options.mounting.size() == 3) {
    mounting = {options.mounting[0], options.mounting[1], options.mounting[2]};
  } else if (!options.log.empty()) {
    mounting = log::read_observations(options.log).front().scan.robot_from_laser;
  } else {
    throw InputError("--frame laser", "needs to know where the laser sits",
                     "give --mounting x,y,theta or --log LOG");
  }
  for (log::StampedPose& pose : poses) pose.pose = pose.pose * mounting;
}

Json compare_with(const EvaluateOptions& options, std::span<const log::StampedPose> trajectory,
                  std::span<const log::Relation> relations) {
  auto other = log::read_trajectory(options.against);
  if (options.frame == "laser") move_to_laser(other, options);
  const PairedErrors paired = paired_relation_errors(trajectory, other, relations);
  if (paired.matched == 0) {
    throw InputError(options.against, "no relation has partners in both trajectories",
                     "give a trajectory of the same log");
  }
  return {{"against", options.against},
          {"matched", paired.matched},
          {"mean_difference_m", paired.mean_difference_m},
          {"interval_m", {paired.difference_m.low, paired.difference_m.high}}};
}

Json evaluate(const EvaluateOptions& options) {
  if (!options.against.empty() && options.relations.empty()) {
    throw InputError("--against", "compares by relations only", "give --relations FILE");
  }
  if (options.truth.empty() && options.relations.empty()) {
    throw InputError("command line", "nothing to compare with",
                     "give --truth FILE or --relations FILE");
  }
  auto trajectory = log::read_trajectory(options.trajectory);
  if (options.frame == "laser") move_to_laser(trajectory, options);
  Json result;
  result["trajectory"] = options.trajectory;
  result["poses"] = trajectory.size();
  result["frame"] = options.frame;
  if (!options.truth.empty()) {
    log::TrajectoryReport report;
    const auto truth = log::read_trajectory(options.truth, options.truth_offset_s, &report);
    const Pose2 motion = alignment(trajectory, truth);
    const TrajectoryErrors absolute = absolute_errors(trajectory, truth, Pose2{});
    require_matches(absolute, options.truth);
    result["truth"] = options.truth;
    result["truth_rows_left_out"] = report.unreliable;
    result["absolute"] = to_json(absolute);
    result["aligned"] = to_json(absolute_errors(trajectory, truth, motion));
    result["aligned"]["truth_from_trajectory"] = {motion.x, motion.y, motion.theta};
    result["relative"] = to_json(relative_errors(trajectory, truth, options.delta_s));
    result["relative"]["delta_s"] = options.delta_s;
  }
  if (!options.relations.empty()) {
    auto relations = log::read_relations(options.relations);
    const Duration offset = Duration::from_seconds(options.truth_offset_s);
    for (log::Relation& relation : relations) {
      relation.first = relation.first + offset;
      relation.second = relation.second + offset;
    }
    const TrajectoryErrors errors = relation_errors(trajectory, relations);
    require_matches(errors, options.relations);
    result["relations_file"] = options.relations;
    result["relations"] = to_json(errors);
    if (!options.against.empty()) result["paired"] = compare_with(options, trajectory, relations);
  }
  return result;
}

void print_row(const char* name, const Json& errors) {
  const auto row = [](const Json& e, const char* unit) {
    std::printf("mean %.4f  median %.4f  p95 %.4f  max %.4f  rmse %.4f  mean squared %.6f %s\n",
                e["mean"].get<double>(), e["median"].get<double>(), e["p95"].get<double>(),
                e["max"].get<double>(), e["rmse"].get<double>(), e["mean_squared"].get<double>(),
                unit);
  };
  std::printf("%-10s (%zu compared, %zu without a partner in time)\n", name,
              errors["matched"].get<std::size_t>(), errors["unmatched"].get<std::size_t>());
  std::printf("  translation  ");
  row(errors["error_m"], "m");
  std::printf("  rotation     ");
  row(errors["error_rad"], "rad");
}

void run_evaluate(const EvaluateOptions& options, VerbContext& /*context*/) {
  const Json result = evaluate(options);
  if (options.json) {
    std::cout << log::json_text(result);
    return;
  }
  std::cout << options.trajectory << ": " << result["poses"] << " poses, frame " << options.frame
            << std::endl;
  for (const char* name : {"absolute", "aligned", "relative", "relations"}) {
    if (result.contains(name)) print_row(name, result[name]);
  }
  if (result.contains("paired")) {
    const Json& paired = result["paired"];
    const auto mm = [](const Json& metres) { return 1e3 * metres.get<double>(); };
    const bool shown = mm(paired["interval_m"][0]) > 0.0 || mm(paired["interval_m"][1]) < 0.0;
    std::printf(
        "paired     (%zu relations, less %s)\n  translation  %+.2f mm, 95%% %+.2f to %+.2f%s\n",
        paired["matched"].get<std::size_t>(), options.against.c_str(),
        mm(paired["mean_difference_m"]), mm(paired["interval_m"][0]), mm(paired["interval_m"][1]),
        shown ? "" : ": no difference shown");
  }
  std::fflush(stdout);
}

}  // namespace

void add_evaluate(CLI::App& app, VerbContext& context) {
  const auto [verb, options] = add_verb<EvaluateOptions>(
      app, context, "evaluate", "errors of a trajectory",
      "strata evaluate maps/trajectory.tum --relations intel.relations --frame laser "
      "--log intel.clf.gz",
      run_evaluate);
  verb->add_option("TRAJECTORY", options->trajectory,
                   "TUM, `t x y theta`, corrected CARMEN log, or poses of a bag, BAG:/topic")
      ->required();
  verb->add_option("--truth", options->truth, "poses to compare with, same formats");
  verb->add_option("--truth-offset", options->truth_offset_s,
                   "seconds added to the stamps of the truth and of the relations");
  verb->add_option("--relations", options->relations, "hand-verified relative poses");
  verb->add_option("--against", options->against,
                   "another trajectory of the log: is it better by the relations?");
  verb->add_option("--frame", options->frame, "whose poses truth and relations are")
      ->check(CLI::IsMember({"robot", "laser"}))
      ->capture_default_str();
  verb->add_option("--mounting", options->mounting, "x,y,theta of the laser on the robot")
      ->delimiter(',')
      ->expected(3);
  verb->add_option("--log", options->log, "log to take the mounting from");
  verb->add_option("--delta", options->delta_s, "time between the poses of relative errors, s")
      ->check(positive())
      ->capture_default_str();
  verb->add_flag("--json", options->json, "as JSON on stdout");
}

}  // namespace strata::tools
