// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/run_options.hpp"

#include "components/log/log_reader.hpp"
#include "core/base/error.hpp"

namespace strata::tools {

void add_max_range(CLI::App& verb, double& max_range_m) {
  verb.add_option("--max-range", max_range_m,
                  "metres: readings from here on say that nothing came back (else what the log "
                  "states, or its readings tell; see `strata info`)")
      ->check(CLI::Range(0.1, 1000.0));
}

void add_odometry_lag(CLI::App& verb, std::optional<double>& lag_s) {
  verb.add_option("--odometry-lag", lag_s,
                  "seconds: how much later than a scan odometry of the same moment is stamped; 0 "
                  "takes stamps as they are (else what turns tell; see `strata info`)")
      ->check(CLI::Range(-10.0, 10.0));
}

void add_scan_topics(CLI::App& verb, std::vector<std::string>& topics, CloudSliceConfig& cloud) {
  verb.add_option(
          "--scan-topic", topics,
          "of a bag: the topic to use, once for each scanner, LaserScan or PointCloud2; else "
          "the only one, or /scan")
      ->allow_extra_args(false);
  verb.add_option("--min-height", cloud.min_height_m,
                  "metres above the robot's frame: lowest point of a cloud that makes a scan")
      ->capture_default_str();
  verb.add_option("--max-height", cloud.max_height_m, "... and the highest")->capture_default_str();
}

void require_scan_topics(const std::vector<std::string>& topics, const CloudSliceConfig& cloud,
                         const std::string& log) {
  require_valid(cloud, "--min-height, --max-height");
  if (topics.empty() || log::detect_format(log) != log::LogFormat::kCarmen) return;
  throw InputError("--scan-topic", "is for bags, and " + log + " is a CARMEN log", "leave it out");
}

void add_run_options(CLI::App& verb, pipeline::RunsInput& input) {
  verb.add_option("--poses", input.poses,
                  "use these poses instead of scan matching; TUM, `t x y theta ...` or a corrected "
                  "CARMEN log, once per log");
  verb.add_option("--truth", input.truths, "ground truth, the same formats, once per log");
  verb.add_option("--truth-offset", input.truth_offset_s, "seconds to add to the truth's stamps");
  verb.add_option("--from", input.from_s, "seconds from the start of each log");
  verb.add_option("--to", input.to_s, "seconds from the start of each log");
  add_scan_topics(verb, input.scan_topics, input.cloud);
  add_max_range(verb, input.max_range_m);
  add_odometry_lag(verb, input.odometry_lag_s);
  verb.add_flag("!--no-odometry", input.use_odometry, "leave the odometry out");
}

void note_reports(VerbContext& context, const pipeline::Runs& runs) {
  for (const log::ReadReport& report : runs.reports) {
    if (report.bad_lines > 0) {
      context.note(std::to_string(report.bad_lines) +
                   " unreadable lines or messages were skipped, the first at " + report.first_bad);
    }
    if (report.scans_without_beams > 0) {
      context.note(std::to_string(report.scans_without_beams) +
                   " scans without beams were skipped");
    }
    if (report.scans_without_odometry > 0) {
      context.note(std::to_string(report.scans_without_odometry) +
                   " scans without odometry were skipped");
    }
    for (const std::string& warning : report.warnings) context.note(warning);
  }
}

}  // namespace strata::tools
