// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/single_scan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>

#include "components/log/trajectory_file.hpp"
#include "core/geometry/angle.hpp"
#include "core/localization/global_search.hpp"
#include "core/localization/place_ranking.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/rays/scan_beams.hpp"
#include "tools/laboratory/experiments/simulated_maps.hpp"
#include "tools/pipeline/runs_input.hpp"

namespace strata::experiments {
namespace {

constexpr double kRight_m = 1.0;
constexpr double kRight_rad = 0.2618;
constexpr std::size_t kEvery = 10;
constexpr double kSameStamp_s = 1.1e-3;

/// Of this thread.
double cpu_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

bool is_right(const Pose2& pose, const Pose2& truth) {
  return translation_distance(pose, truth) < kRight_m &&
         std::abs(wrap_angle(pose.theta - truth.theta)) < kRight_rad;
}

/// Whether a pose was given for just this moment, and not made from two others.
bool is_given(const std::vector<log::StampedPose>& poses, Stamp stamp) {
  const Duration slack = Duration::from_seconds(kSameStamp_s);
  const auto at = std::lower_bound(
      poses.begin(), poses.end(), stamp - slack,
      [](const log::StampedPose& pose, Stamp value) { return pose.stamp < value; });
  return at != poses.end() && (at->stamp - stamp).ns <= slack.ns;
}

/// Two degrees between beams: one scan alone has to say more than one of many.
std::shared_ptr<const localization::SensorModel> fine_model(const ReflectionGrid& map) {
  localization::BeamModelConfig config;
  config.beams.min_angle_rad = 0.0349;
  config.mixture.hit_stddev_m = 0.1;
  config.tempering = 1.0;
  return localization::make_grid_beam_model(map, config);
}

}  // namespace

SingleScanCounts locate_single_scans(const std::string& log, const std::string& poses,
                                     double margin_nats, int step) {
  pipeline::RunsInput input;
  input.logs = {log};
  input.poses = {poses};
  const pipeline::Runs runs = pipeline::read_runs(input, nullptr);
  const std::vector<log::StampedPose> given = log::read_trajectory(poses);
  std::vector<PosedScan> learned;
  std::vector<std::size_t> tested;
  std::size_t posed = 0;
  for (std::size_t i = 0; i < runs.observations.size(); ++i) {
    const Scan& scan = runs.observations[i].scan;
    if (!runs.poses[i]) continue;
    if (posed++ % kEvery == 0) {
      if (rays::says_something(scan)) tested.push_back(i);
    } else if (is_given(given, scan.stamp)) {
      learned.push_back({0, scan, *runs.poses[i], {}});
    }
  }
  const ReflectionGrid map = static_maps(learned).filtered;
  const localization::GlobalSearch search(map);
  const auto model = fine_model(map);
  WorkerPool pool(1);
  SingleScanCounts counts;
  for (std::size_t t = 0; t < tested.size(); t += static_cast<std::size_t>(step)) {
    const Scan& scan = runs.observations[tested[t]].scan;
    const Pose2& truth = *runs.poses[tested[t]];
    const double begin_s = cpu_s();
    const auto candidates = search.search(
        localization::spread_out(endpoints_in_robot(scan), search.config().resolution_m,
                                 static_cast<std::size_t>(search.config().max_points)));
    const auto places = localization::rank_places(candidates, scan, *model, {}, pool);
    const double took_s = cpu_s() - begin_s;
    ++counts.scans;
    counts.mean_s += took_s;
    counts.max_s = std::max(counts.max_s, took_s);
    counts.candidates += static_cast<double>(places.size());
    counts.found += std::any_of(places.begin(), places.end(), [&](const auto& place) {
      return is_right(place.map_from_robot, truth);
    });
    const bool is_first = !places.empty() && is_right(places.front().map_from_robot, truth);
    const bool is_sure = localization::margin_of(places, kRight_m, kRight_rad) >= margin_nats;
    counts.right += is_first ? 1 : 0;
    counts.accepted += is_sure ? 1 : 0;
    counts.wrong_accepted += is_sure && !is_first ? 1 : 0;
  }
  const auto scans = static_cast<double>(std::max<std::size_t>(counts.scans, 1));
  counts.mean_s /= scans;
  counts.candidates /= scans;
  return counts;
}

void report_single_scans(const std::vector<std::string>& logs,
                         const std::vector<std::string>& poses, double margin_nats, int step) {
  for (std::size_t i = 0; i < logs.size(); ++i) {
    const SingleScanCounts c = locate_single_scans(logs[i], poses[i], margin_nats, step);
    const double percent = 100.0 / static_cast<double>(std::max<std::size_t>(c.scans, 1));
    std::printf(
        "%s: %zu scans; right place among the candidates %.1f%%, the likeliest %.1f%%; accepted at "
        "%.0f nats %.1f%%, of these wrong %zu; %.0f candidates; %.0f ms of one core, at most "
        "%.0f\n",
        std::filesystem::path(logs[i]).filename().c_str(), c.scans,
        percent * static_cast<double>(c.found), percent * static_cast<double>(c.right), margin_nats,
        percent * static_cast<double>(c.accepted), c.wrong_accepted, c.candidates, 1e3 * c.mean_s,
        1e3 * c.max_s);
    std::fflush(stdout);
  }
}

}  // namespace strata::experiments
