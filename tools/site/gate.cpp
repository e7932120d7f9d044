// SPDX-License-Identifier: Apache-2.0
#include "tools/site/gate.hpp"

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <utility>

#include "components/maps/map_model.hpp"
#include "core/base/error.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "tools/pipeline/localize.hpp"
#include "tools/report/plot.hpp"
#include "tools/site/new_run_check.hpp"

namespace strata::site {
namespace {

using report::fixed;

constexpr double kStartStddev_m = 0.2;
constexpr double kStartStddev_rad = 0.1;
/// From such a score on the robot counts as found.
constexpr double kFoundScore = 0.6;
/// Of a recording: fewer are no drive.
constexpr std::size_t kMinScans = 10;

struct Side {
  maps::Maps maps;
  maps::MapModel model;
};

/// Looks at the maps by themselves: a map that is folded is so wherever it is compared.
void check_fold(const std::filesystem::path& candidate, GateReport& report) {
  std::ifstream in(candidate / maps::kSummaryFile);
  const nlohmann::json summary = nlohmann::json::parse(in, nullptr, false);
  const bool says =
      summary.is_object() && summary.contains("consistency") && summary["consistency"].is_object();
  GateCheck check{"fold", "", true, "the maps do not say whether they contradict themselves"};
  if (says) {
    const nlohmann::json& consistency = summary["consistency"];
    check.passed = consistency.value("consistent", true);
    check.text = check.passed ? "the map does not contradict itself" : "the map contradicts itself";
    for (const nlohmann::json& place : consistency.value("places", nlohmann::json::array())) {
      if (check.passed) break;
      check.text += "; at (" + fixed(place.value("x", 0.0), 1) + ", " +
                    fixed(place.value("y", 0.0), 1) + "): " + place.value("why", "");
    }
  }
  report.checks.push_back(check);
}

void check_frame(const ReflectionGrid& active, const ReflectionGrid& candidate,
                 const GateConfig& config, GateReport& report) {
  if (active.resolution_m() != candidate.resolution_m()) {
    report.checks.push_back({"frame", "", false,
                             "cells of " + fixed(candidate.resolution_m(), 3) + " m, not " +
                                 fixed(active.resolution_m(), 3) + " m as in the active version"});
    return;
  }
  const double area = known_share(active, candidate);
  report.checks.push_back({"area", "", area >= config.min_common_area,
                           "knows " + report::percent(area, 1) +
                               " of what the active version knows (least " +
                               report::percent(config.min_common_area, 1) + ")"});
  report.shift = map_shift(candidate, active);
  const MapShift& shift = *report.shift;
  const bool has_walls = shift.converged && shift.common_walls >= config.min_common_walls;
  report.checks.push_back({"walls", "", has_walls,
                           report::percent(shift.common_walls, 1) +
                               " of the active version's walls lie on the candidate's (least " +
                               report::percent(config.min_common_walls, 1) + ")"});
  const bool is_there =
      shift.shift_m <= config.max_shift_m && shift.turn_rad <= config.max_turn_rad;
  report.checks.push_back({"frame", "", is_there,
                           "the frame lies " + fixed(shift.shift_m, 3) + " m and " +
                               fixed(shift.turn_rad, 4) + " rad from the active version's (most " +
                               fixed(config.max_shift_m, 3) + " m, " +
                               fixed(config.max_turn_rad, 4) + " rad)"});
}

/// Holds the frame against the oldest version that the candidate still shares its walls with: steps
/// that are each too small to be refused must not add up.
void check_drift(const GateTask& task, const ReflectionGrid& candidate, const GateConfig& config,
                 GateReport& report) {
  for (const std::filesystem::path& folder : task.earlier) {
    if (task.is_whole && !task.is_whole(folder))
      continue;  // it would say that the frame is another
    const ReflectionGrid first = maps::read_maps(folder).filtered;
    if (first.resolution_m() != candidate.resolution_m()) continue;
    const MapShift shift = map_shift(candidate, first);
    if (!shift.converged || shift.common_walls < config.min_common_walls) continue;
    report.drift = shift;
    const bool is_there =
        shift.shift_m <= config.max_drift_m && shift.turn_rad <= config.max_turn_rad;
    report.checks.push_back(
        {"drift", "", is_there,
         "the frame lies " + fixed(shift.shift_m, 3) + " m and " + fixed(shift.turn_rad, 4) +
             " rad from that of the first version with these walls (most " +
             fixed(config.max_drift_m, 3) + " m, " + fixed(config.max_turn_rad, 4) + " rad)"});
    return;
  }
}

std::string model_for(const GateTask& task, const maps::Maps& candidate,
                      const std::optional<maps::Maps>& active) {
  if (!task.model.empty()) return task.model;
  const bool has_patches = candidate.patches && (!active || active->patches);
  return has_patches ? "patch" : "filtered";
}

/// The part of a recording that robots are localized on.
struct Recording {
  std::vector<Observation> observations;
  std::vector<std::optional<Pose2>> truths;
};

std::pair<Drive, pipeline::LocalizationRun> drive(const Side& side, const Recording& recording,
                                                  const std::optional<Pose2>& start,
                                                  const GateTask& task, const GateConfig& config,
                                                  Progress* progress) {
  pipeline::LocalizationStart from;
  if (start) from.map_from_robot = {*start, pose_covariance(kStartStddev_m, kStartStddev_rad)};
  pipeline::MapFit fit(side.maps.filtered);
  pipeline::LocalizationRun run =
      pipeline::localize(recording.observations, recording.truths, side.model, side.maps.filtered,
                         config.localizer, from, task.seed, task.threads, progress, &fit);
  Drive result;
  result.fit = fit.fit();
  result.explained = result.fit.share(pipeline::FitState::kExplained);
  result.contradicted = result.fit.share(pipeline::FitState::kContradicted);
  const auto lost =
      std::count(run.health.begin(), run.health.end(), localization::HealthState::kLost);
  const double scans = static_cast<double>(std::max<std::size_t>(1, run.health.size()));
  result.lost = static_cast<double>(lost) / scans;
  for (const double score : run.scores) result.score += score / scans;
  if (!run.errors.empty()) {
    double sum = 0.0;
    for (const pipeline::ScanError& error : run.errors) sum += error.error_m;
    result.error_m = sum / static_cast<double>(run.errors.size());
  }
  return {std::move(result), std::move(run)};
}

/// Cuts the recording to where the robot is found; where that is. Nothing: it never is.
std::optional<Pose2> find_start(const Side& side, Recording& recording, const GateTask& task,
                                const GateConfig& config, Progress* progress) {
  if (!recording.truths.empty() && recording.truths.front()) return recording.truths.front();
  const auto [first, run] = drive(side, recording, std::nullopt, task, config, progress);
  if (!first.fit.is_explained()) return std::nullopt;
  const std::optional<std::size_t> at = found_at(run.scores, run.place_scores);
  if (!at) return std::nullopt;
  const auto before = static_cast<std::ptrdiff_t>(*at);
  recording.observations.erase(recording.observations.begin(),
                               recording.observations.begin() + before);
  if (!recording.truths.empty()) {
    recording.truths.erase(recording.truths.begin(), recording.truths.begin() + before);
  }
  return run.trajectory[*at].pose;
}

void compare(const GateLog& log, const GateConfig& config, GateReport& report) {
  const auto check = [&](const char* name, double now, double before, double room, bool is_rise,
                         const std::string& what, int digits) {
    const double worse = is_rise ? now - before : before - now;
    const auto text = [&](double value) {
      return digits == 0 ? report::percent(value, 1) : fixed(value, digits);
    };
    report.checks.push_back({name, log.log, worse <= room,
                             what + " " + text(now) + ", in the active version " + text(before)});
  };
  const Drive& now = log.candidate;
  const Drive& before = *log.active;
  check("losses", now.lost, before.lost, config.max_lost_rise, true, "scans lost:", 0);
  check("contradictions", now.contradicted, before.contradicted, config.max_contradicted_rise, true,
        "scans that contradict the map:", 0);
  check("fit", now.explained, before.explained, config.max_explained_drop, false,
        "scans that fit the map:", 0);
  check("score", now.score, before.score, config.max_score_drop, false, "mean score:", 3);
  if (now.error_m && before.error_m) {
    check("error", *now.error_m, *before.error_m, config.max_error_rise_m, true,
          "mean error [m]:", 3);
  }
}

void drive_log(std::size_t number, const GateTask& task, const GateConfig& config,
               const std::optional<Side>& active, const Side& candidate, Progress* progress,
               GateReport& report) {
  pipeline::RunsInput input = task.input;
  input.logs = {task.input.logs[number]};
  input.truths.clear();
  if (!task.input.truths.empty()) input.truths = {task.input.truths[number]};
  pipeline::Runs runs = pipeline::read_runs(input, progress);
  Recording recording{std::move(runs.observations), std::move(runs.truths)};
  const Side& known = active ? *active : candidate;
  for (auto& truth : recording.truths) {
    if (truth && known.maps.map_from_truth) truth = *known.maps.map_from_truth * *truth;
  }
  GateLog log;
  log.log = input.logs.front();
  for (const Observation& seen : recording.observations) log.period.add(seen.scan.stamp);
  const std::optional<Pose2> start = find_start(known, recording, task, config, progress);
  if (!start && active) {
    log.passed_over = "the robot is not found in the active version";
    report.logs.push_back(std::move(log));
    return;
  }
  if (recording.observations.size() < kMinScans) {
    log.passed_over = "there are only " + std::to_string(recording.observations.size()) +
                      " scans from where the robot is found on; at least " +
                      std::to_string(kMinScans) + " say something";
    report.logs.push_back(std::move(log));
    return;
  }
  log.candidate = drive(candidate, recording, start, task, config, progress).first;
  if (active) {
    log.active = drive(*active, recording, start, task, config, progress).first;
    compare(log, config, report);
  } else {
    report.checks.push_back(
        {"fit", log.log, log.candidate.explained >= config.min_explained,
         "scans that fit the map: " + report::percent(log.candidate.explained, 1) + " (least " +
             report::percent(config.min_explained, 1) + ")"});
  }
  report.logs.push_back(std::move(log));
}

}  // namespace

std::optional<std::size_t> found_at(std::span<const double> scores,
                                    std::span<const double> place_scores) {
  const auto first_of = [](std::span<const double> all) {
    const auto found =
        std::find_if(all.begin(), all.end(), [](double score) { return score >= kFoundScore; });
    return static_cast<std::size_t>(found - all.begin());
  };
  const std::size_t alone = first_of(scores);
  if (alone + kMinScans <= scores.size()) return alone;
  const std::size_t alike = first_of(place_scores);
  return alike < place_scores.size() ? std::optional(alike) : std::nullopt;
}

bool GateReport::passed() const {
  return std::all_of(checks.begin(), checks.end(),
                     [](const GateCheck& check) { return check.passed; });
}

GateReport run_gate(const GateTask& task, const GateConfig& config, Progress* progress) {
  GateReport report;
  Side candidate{maps::read_maps(task.candidate), {}};
  std::optional<maps::Maps> active_maps;
  if (task.active) active_maps = maps::read_maps(*task.active);
  check_fold(task.candidate, report);
  std::vector<NewRun> new_runs;
  if (active_maps) {
    check_frame(active_maps->filtered, candidate.maps.filtered, config, report);
    new_runs = judge_new_runs(task.candidate, *task.active, active_maps->filtered);
  }
  check_drift(task, candidate.maps.filtered, config, report);
  if (task.input.logs.empty()) {
    check_new_runs(new_runs, config, report);
    return report;
  }
  report.model = model_for(task, candidate.maps, active_maps);
  candidate.model = maps::make_map_model(candidate.maps, report.model, {});
  std::optional<Side> active;
  if (active_maps) {
    active.emplace(Side{std::move(*active_maps), {}});
    active->model = maps::make_map_model(active->maps, report.model, {});
  }
  for (std::size_t i = 0; i < task.input.logs.size(); ++i) {
    drive_log(i, task, config, active, candidate, progress, report);
  }
  check_new_runs(new_runs, config, report);
  const auto says_something = [](const GateLog& log) { return log.passed_over.empty(); };
  if (std::none_of(report.logs.begin(), report.logs.end(), says_something)) {
    report.checks.push_back({"recordings", "", false, "none of them says anything"});
  }
  return report;
}

}  // namespace strata::site
