// SPDX-License-Identifier: Apache-2.0
/// From the command line of `strata compare` to what the pipeline is given.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/pipeline/compare.hpp"
#include "tools/pipeline/runs_input.hpp"
#include "tools/strata/compare_options.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// Throws InputError for options that contradict each other.
void require_one_way(const CompareOptions& options);

/// The configuration with the models that are asked for. Throws ConfigError.
[[nodiscard]] pipeline::CompareConfig compare_config_of(const CompareOptions& options,
                                                        VerbContext& context);

/// As many as asked for, from `first` on.
[[nodiscard]] std::vector<std::uint64_t> seeds_of(const CompareOptions& options,
                                                  std::uint64_t first);

/// A comparison that is read and ready to begin.
struct PreparedComparison {
  pipeline::Runs runs;
  pipeline::CompareJob job;
};
/// Throws InputError, and notes what reading met.
[[nodiscard]] PreparedComparison prepare_comparison(const CompareOptions& options,
                                                    const pipeline::RunsInput& input,
                                                    const pipeline::CompareConfig& config,
                                                    VerbContext& context);

/// The i-th log as a building of its own, and the name of its folder. Throws InputError.
[[nodiscard]] pipeline::RunsInput building_input(const CompareOptions& options, std::size_t i);
[[nodiscard]] std::string building_folder(const CompareOptions& options, std::size_t i);

}  // namespace strata::tools
