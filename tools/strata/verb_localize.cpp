// SPDX-License-Identifier: Apache-2.0
/// `strata localize LOG --maps MAPS --model M --out DIR`.
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "components/log/json_text.hpp"
#include "components/log/log_config.hpp"
#include "components/maps/map_model.hpp"
#include "components/maps/refiner.hpp"
#include "components/settings/settings.hpp"
#include "components/site/active_maps.hpp"
#include "core/base/error.hpp"
#include "memory/decoding/decoding_config.hpp"
#include "tools/pipeline/cost.hpp"
#include "tools/pipeline/drive_replay.hpp"
#include "tools/pipeline/localize.hpp"
#include "tools/pipeline/localize_output.hpp"
#include "tools/pipeline/localize_picture.hpp"
#include "tools/pipeline/map_fit.hpp"
#include "tools/report/drawings.hpp"
#include "tools/report/plot.hpp"
#include "tools/strata/fit_warning.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/run_options.hpp"
#include "tools/strata/terminal_picture.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"
#include "tools/strata/warning.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {
namespace {

struct LocalizeOptions {
  pipeline::RunsInput input;
  std::string log;
  std::string maps;
  std::string model = "patch";
  std::string out;
  std::string initial_pose;
  bool global = false;
  bool json = false;
};

struct LocalizeConfig {
  localization::LocalizerConfig localizer;
  maps::SensorModelKind sensor_model = maps::SensorModelKind::kBeam;
  patch_beams::PatchBeamModelConfig sensor;
  localization::LikelihoodFieldModelConfig likelihood_field;
  memory::DecodingConfig decoding;
  maps::TimescaleUseConfig timescale_use;
  refinement::RefinementConfig refinement;
  log::LogConfig log;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("localizer", c.localizer, "the particle filter");
    v.field("sensor_model", c.sensor_model, {.doc = maps::sensor_model_doc()});
    v.group("sensor", c.sensor, "what beams measure in a map");
    v.group("likelihood_field", c.likelihood_field, "the sensor model likelihood_field");
    v.group("decoding", c.decoding, "how levels of the timescale memory become expected scans");
    v.group("timescale_use", c.timescale_use, "how the timescale memory is used");
    v.group("refinement", c.refinement, "poses finer than the filter's");
    v.group("log", c.log, "what the log does not say of itself");
  }
};

constexpr double kStartStddev_m = 0.2;
constexpr double kStartStddev_rad = 0.1;

Pose2 parse_pose(const std::string& text) {
  Pose2 pose;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &pose.x, &pose.y, &pose.theta, &rest) != 3 ||
      !is_finite(pose)) {
    throw InputError("--initial-pose " + text, "is not x,y,theta",
                     "give metres, metres, radians, such as 1.5,-2,0.3");
  }
  return pose;
}

/// --initial-pose, else the first true pose, else nowhere: a global start.
pipeline::LocalizationStart start_of(const LocalizeOptions& options,
                                     const std::vector<std::optional<Pose2>>& truths,
                                     VerbContext& context) {
  if (options.global) return {};
  std::optional<Pose2> pose;
  if (!options.initial_pose.empty()) {
    pose = parse_pose(options.initial_pose);
  } else if (!truths.empty()) {
    pose = truths.front();
  }
  if (!pose) {
    context.note("no initial pose is known: starting globally, as with --global");
    return {};
  }
  const double m2 = kStartStddev_m * kStartStddev_m;
  const double rad2 = kStartStddev_rad * kStartStddev_rad;
  return {Pose2Gaussian{*pose, Eigen::Vector3d(m2, m2, rad2).asDiagonal()}};
}

double way_m(const std::vector<log::StampedPose>& trajectory) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    length_m += translation_distance(trajectory[i - 1].pose, trajectory[i].pose);
  }
  return length_m;
}

std::string sentence(const pipeline::LocalizationRun& run, const pipeline::LogFit& fit,
                     const nlohmann::json& metrics, const LocalizeOptions& options) {
  using report::fixed;
  std::string text =
      "localized " + counted(run.trajectory.size(), "scan") + " over " +
      fixed(way_m(run.trajectory), 1) + " m in " + fixed(metrics["cost"]["wall_s"], 1) + " s; " +
      (fit.scans.empty()
           ? "none of them says where it is"
           : "the maps explain " + report::percent(fit.share(pipeline::FitState::kExplained), 0) +
                 " of the drive, at a score of " + fixed(metrics["score"]["mean"], 2) +
                 " in the mean");
  if (!metrics["error_m"].is_null()) {
    text += "; error " + fixed(metrics["error_m"]["mean"], 3) + " m in the mean, " +
            fixed(metrics["error_m"]["p95"], 3) + " m in 95% of the scans" +
            (metrics["lost"].get<bool>() ? ", lost" : "");
  }
  return text + "; drawn in " +
         (std::filesystem::path(options.out) / pipeline::kTrajectoryPicture).string() +
         ", to be replayed in " + pipeline::kReplayPage + " beside it";
}

void warn_of_bad_fit(const pipeline::LogFit& fit, const nlohmann::json& metrics,
                     const LocalizeOptions& options, bool is_global, VerbContext& context) {
  LocalizedLog log{fit, std::nullopt, options.model, ""};
  const nlohmann::json& score = metrics["score"]["place_mean"];
  if (!score.is_null()) log.mean_score = score.get<double>();
  if (!is_global) {
    log.begin = options.initial_pose.empty() ? "the first pose of --truth" : "--initial-pose";
  }
  warn(context, start_warning(metrics["relocations"], log.begin));
  const std::string warning = fit_warning(log);
  if (warning.empty()) return;
  warn(context, warning + (is_global ? "" : " --global looks for it everywhere"));
}

void run_localize(const LocalizeOptions& options, VerbContext& context) {
  const pipeline::CostMeter meter;
  const auto config = read_config<LocalizeConfig>(context);
  ResultDirectory out(options.out, "localization", context);
  pipeline::RunsInput input = with_config(options.input, config.log);
  input.logs = {options.log};
  maps::Maps maps = maps::read_maps(site::maps_or_active(options.maps));
  maps.decoding = config.decoding;
  maps.timescale_use = config.timescale_use;
  const maps::MapModel model =
      config.sensor_model == maps::SensorModelKind::kBeam
          ? maps::make_map_model(maps, options.model, config.sensor)
          : maps::make_likelihood_field_model(maps, options.model, config.likelihood_field);
  pipeline::Runs runs = pipeline::read_runs(input, context.progress());
  note_reports(context, runs);
  for (auto& truth : runs.truths) {
    if (truth && maps.map_from_truth) truth = *maps.map_from_truth * *truth;
  }
  const pipeline::LocalizationStart start = start_of(options, runs.truths, context);
  pipeline::MapFit fit(maps.filtered);
  const auto refiner = maps::make_refiner(maps, *model.descriptor, config.refinement);
  const pipeline::LocalizationRun run = pipeline::localize(
      runs.observations, runs.truths, model, maps.filtered, config.localizer, start,
      context.options.seed, context.options.threads, context.progress(), &fit, refiner.get());
  pipeline::LocalizeSummary summary{options.model, context.options.seed, config.localizer.particles,
                                    meter.read(), maps.map_from_truth};
  const nlohmann::json metrics = pipeline::write_localization(out.path(), run, summary, &fit.fit());
  report::Drawings drawings;
  drawings.add(out.path() / pipeline::kTrajectoryPicture,
               [&] { pipeline::write_trajectory_picture(out.path(), maps.filtered, fit.fit()); });
  drawings.add(out.path() / pipeline::kReplayPage, [&] {
    const auto* patches = maps::patches_of(*model.descriptor, maps);
    pipeline::write_replay(
        out.path(),
        {maps.filtered,
         runs.observations,
         runs.truths,
         {{options.model, run.trajectory, run.states, run.scores, patches, run.shown_particles}}});
  });
  out.commit();
  warn(context, drawings.what_is_missing());
  warn_of_bad_fit(fit.fit(), metrics, options, !start.map_from_robot, context);
  const nlohmann::json& error = metrics["error_m"];
  const std::string frame = frame_warning(
      fit.fit(), error.is_null() ? std::nullopt : std::optional(error["mean"].get<double>()),
      maps.map_from_truth.has_value());
  if (!frame.empty()) warn(context, frame);
  if (options.json) {
    std::cout << log::json_text(metrics);
  } else if (!context.options.quiet) {
    report::TerminalWay way;
    for (const log::StampedPose& pose : run.trajectory) way.push_back(pose.pose);
    show_map(maps.filtered, {&way, 1}, context);
    context.clear_progress();
    std::cout << sentence(run, fit.fit(), metrics, options) << '\n';
  }
}

}  // namespace

void add_localize(CLI::App& app, VerbContext& context) {
  const auto [verb, options] = add_verb<LocalizeOptions>(
      app, context, "localize", "localize a recorded robot in learned maps",
      "strata localize friday.clf --maps maps --model patch --out friday", run_localize);
  verb->add_option("LOG", options->log, "CARMEN log, rosbag2 folder, .db3, .mcap or ROS 1 .bag")
      ->required();
  verb->add_option("--maps", options->maps, "folder that `strata learn` wrote, or a site")
      ->required();
  verb->add_option("--model", options->model,
                   maps::map_models().help(&maps::MapModelDescriptor::is_in_folder))
      ->capture_default_str();
  verb->add_option("--out", options->out,
                   "folder for trajectory.tum and .png, replay.html, refined.tum, states.csv, "
                   "metrics.json")
      ->required();
  add_force(*verb, context);
  verb->add_option("--initial-pose", options->initial_pose, "x,y,theta in the map frame");
  verb->add_flag("--global", options->global, "start without a pose");
  verb->add_flag("--json", options->json, "metrics.json on stdout, instead of a sentence");
  add_run_options(*verb, options->input);
}

}  // namespace strata::tools
