// SPDX-License-Identifier: Apache-2.0
/// The options that verbs on recorded runs share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "components/log/log_config.hpp"
#include "core/scan/cloud_slice.hpp"
#include "tools/pipeline/runs_input.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// Adds --max-range, bound to `max_range_m`, which must outlive the app.
void add_max_range(CLI::App& verb, double& max_range_m);

/// Adds --odometry-lag, bound to `lag_s`, which must outlive the app.
void add_odometry_lag(CLI::App& verb, std::optional<double>& lag_s);

/// Adds --scan-topic, --min-height and --max-height, bound to `topics` and `cloud`, which must
/// outlive the app.
void add_scan_topics(CLI::App& verb, std::vector<std::string>& topics, CloudSliceConfig& cloud);

/// Throws InputError where topics are named for a log that is no bag, ConfigError where the heights
/// leave nothing between them.
void require_scan_topics(const std::vector<std::string>& topics, const CloudSliceConfig& cloud,
                         const std::string& log);

/// Adds --poses, --truth, --truth-offset, --from, --to, --scan-topic with the heights of clouds,
/// --max-range, --odometry-lag and --no-odometry, bound to `input`, which must outlive the app.
void add_run_options(CLI::App& verb, pipeline::RunsInput& input);

/// The input with what the settings say and no option does.
[[nodiscard]] inline pipeline::RunsInput with_config(pipeline::RunsInput input,
                                                     const log::LogConfig& config) {
  if (input.max_range_m <= 0.0) input.max_range_m = config.max_range_m;
  return input;
}

/// Notes on stderr what reading met: damaged lines, skipped scans, assumptions.
void note_reports(VerbContext& context, const pipeline::Runs& runs);

}  // namespace strata::tools
