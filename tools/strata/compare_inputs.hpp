// SPDX-License-Identifier: Apache-2.0
/// What decides whether two shards are of one comparison.
#pragma once

#include <cstddef>
#include <string>

#include "tools/pipeline/runs_input.hpp"
#include "tools/shards/shard_folder.hpp"
#include "tools/strata/compare_options.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

inline constexpr const char* kCompareJob = "strata compare";

/// Everything but what is read. settings: the configuration as text.
[[nodiscard]] shards::ShardInfo shard_info_of(const CompareOptions& options,
                                              const std::string& settings,
                                              const shards::Shard& shard,
                                              const VerbContext& context);

/// Adds the fingerprints of the files of a building. Throws InputError. O(bytes).
void add_inputs(const pipeline::RunsInput& input, std::size_t building, shards::ShardInfo& info);

}  // namespace strata::tools
