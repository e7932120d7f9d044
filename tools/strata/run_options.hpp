// SPDX-License-Identifier: Apache-2.0
/// The options that verbs on recorded runs share.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tools/pipeline/runs_input.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// Adds --poses, --truth, --truth-offset, --from, --to and --no-odometry, bound to `input`, which
/// must outlive the app.
void add_run_options(CLI::App& verb, pipeline::RunsInput& input);

/// Notes on stderr what reading met: damaged lines, skipped scans, assumptions.
void note_reports(VerbContext& context, const pipeline::Runs& runs);

}  // namespace strata::tools
