// SPDX-License-Identifier: Apache-2.0
/// `strata compare --shard I/N` and `--merge DIR...`.
#pragma once

#include "tools/pipeline/compare_config.hpp"
#include "tools/strata/compare_options.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// One part of the comparison, for merge_shards, in options.out. Throws Error.
void compare_shard(const CompareOptions& options, const pipeline::CompareConfig& config,
                   VerbContext& context);

/// What one machine would have written and said, of the folders options.merge. Throws Error.
void merge_shards(const CompareOptions& options, VerbContext& context);

}  // namespace strata::tools
