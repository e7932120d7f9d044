// SPDX-License-Identifier: Apache-2.0
/// The folder that a shard leaves: what it is part of, and its results.
///
///     shard.json    which shard of what: for people, and to refuse what does not belong together
///     results.bin   its results, by core/base/state_archive.hpp: for the same program only
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "components/log/compression.hpp"
#include "tools/shards/shard.hpp"

namespace strata::shards {

inline constexpr const char* kShardFile = "shard.json";
inline constexpr const char* kShardResults = "results.bin";

/// What decides whether two shards are of one job.
struct ShardInfo {
  std::string job;  ///< what runs, as "strata compare"
  Shard shard;
  /// Version, settings, options: the same in every shard of a job.
  std::map<std::string, std::string> same;
  /// What it read, by name: fingerprints, the same in all that read it.
  std::map<std::string, std::string> inputs;
};

/// Adds the version and the program's own fingerprint. Only the same program gives the same bits,
/// and can read its results.
[[nodiscard]] ShardInfo shard_info(const std::string& job, const Shard& shard,
                                   const std::string& version);

/// Into a folder that is there. Throws OutputError.
void write_shard(const ShardInfo& info, log::View results, const std::filesystem::path& folder);

/// Throws InputError for a folder without a shard, DamageError for what is damaged.
[[nodiscard]] ShardInfo read_shard_info(const std::filesystem::path& folder);
/// As read_shard_info.
[[nodiscard]] log::Bytes read_shard_results(const std::filesystem::path& folder);

/// A shard and where it lies.
struct ShardFolder {
  std::filesystem::path path;
  ShardInfo info;
};

/// The shards in these folders in their order, when they are all of one job and none is missing.
/// job, version: those of the program that reads. Throws InputError, which names shards that are
/// missing, that are there twice, and what two of them differ in.
[[nodiscard]] std::vector<ShardFolder> read_all_shards(std::span<const std::string> folders,
                                                       const std::string& job,
                                                       const std::string& version);

}  // namespace strata::shards
