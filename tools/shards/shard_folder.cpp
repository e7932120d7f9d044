// SPDX-License-Identifier: Apache-2.0
#include "tools/shards/shard_folder.hpp"

#include <algorithm>
#include <fstream>
#include <set>
#include <utility>

#include <nlohmann/json.hpp>

#include "components/log/state_store.hpp"
#include "core/base/damage.hpp"
#include "core/base/error.hpp"
#include "tools/shards/fingerprint.hpp"

namespace fs = std::filesystem;

namespace strata::shards {
namespace {

using nlohmann::json;

constexpr int kFormat = 1;

std::string run_again(const std::string& shard) {
  return "run the same command again with --shard " + shard;
}

/// The first key whose values differ, or that only one has; empty: none. shared: only keys of both.
std::string differing_key(const std::map<std::string, std::string>& a,
                          const std::map<std::string, std::string>& b, bool shared) {
  for (const auto& [key, value] : a) {
    const auto found = b.find(key);
    if (found == b.end() ? !shared : found->second != value) return key;
  }
  if (shared) return "";
  for (const auto& [key, value] : b) {
    if (a.find(key) == a.end()) return key;
  }
  return "";
}

void require_same_job(const ShardFolder& first, const ShardFolder& other) {
  std::string key = differing_key(first.info.same, other.info.same, false);
  if (key.empty()) key = differing_key(first.info.inputs, other.info.inputs, true);
  if (key.empty() && first.info.shard.count == other.info.shard.count) return;
  if (key.empty()) key = "number of shards";
  throw InputError(other.path.string(),
                   "is of another job than " + first.path.string() + ": its " + key + " differs",
                   "merge shards of one job only, each run by the same program");
}

/// "3/8, 5/8" of those that are not there.
std::string missing(const std::vector<ShardFolder>& shards) {
  const int count = shards.front().info.shard.count;
  std::set<int> there;
  for (const ShardFolder& shard : shards) there.insert(shard.info.shard.index);
  std::string text;
  for (int index = 1; index <= count; ++index) {
    if (there.count(index) == 0) text += (text.empty() ? "" : ", ") + label({index, count});
  }
  return text;
}

}  // namespace

ShardInfo shard_info(const std::string& job, const Shard& shard, const std::string& version) {
  return {job, shard, {{"version", version}, {"program", fingerprint_of_program()}}, {}};
}

void write_shard(const ShardInfo& info, log::View results, const fs::path& folder) {
  log::write_state_file(folder / kShardResults, results);
  const json about = {{"format", kFormat},      {"job", info.job},   {"shard", info.shard.index},
                      {"of", info.shard.count}, {"same", info.same}, {"inputs", info.inputs}};
  std::ofstream out(folder / kShardFile);
  out << about.dump(2) << '\n';
  out.close();
  if (!out) {
    throw OutputError((folder / kShardFile).string(), "cannot be written", "free some space");
  }
}

ShardInfo read_shard_info(const fs::path& folder) {
  std::ifstream in(folder / kShardFile);
  if (!in) {
    throw InputError(folder.string(), "holds no shard", "name folders that --shard I/N wrote");
  }
  try {
    const json about = json::parse(in);
    if (about.at("format") != kFormat) {
      throw InputError((folder / kShardFile).string(), "is of another version",
                       "merge with the program that ran the shards");
    }
    ShardInfo info;
    info.job = about.at("job");
    info.shard = parse_shard(std::to_string(about.at("shard").get<int>()) + "/" +
                             std::to_string(about.at("of").get<int>()));
    about.at("same").get_to(info.same);
    about.at("inputs").get_to(info.inputs);
    return info;
  } catch (const json::exception&) {
    throw DamageError((folder / kShardFile).string(), "is damaged", "run the shard again");
  }
}

log::Bytes read_shard_results(const fs::path& folder) {
  try {
    return log::read_state_file(folder / kShardResults);
  } catch (const InputError& error) {
    throw DamageError(error.place(), error.problem(),
                      run_again(label(read_shard_info(folder).shard)));
  }
}

std::vector<ShardFolder> read_all_shards(std::span<const std::string> folders,
                                         const std::string& job, const std::string& version) {
  std::vector<ShardFolder> shards;
  for (const std::string& folder : folders) {
    ShardFolder shard{folder, read_shard_info(folder)};
    const std::map<std::string, std::string> own = shard_info(job, shard.info.shard, version).same;
    if (shard.info.job != job) {
      throw InputError(folder, "is a shard of " + shard.info.job, "merge it with that");
    }
    for (const auto& [key, value] : own) {
      if (shard.info.same[key] == value) continue;
      throw InputError(folder, "was made by another " + key + " than this one",
                       "merge with the program that ran the shards");
    }
    shards.push_back(std::move(shard));
  }
  if (shards.empty()) throw InputError("--merge", "names no folder", "name those of all shards");
  // Each with each: two may have read an input that the first did not.
  for (std::size_t b = 1; b < shards.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) require_same_job(shards[a], shards[b]);
  }
  std::stable_sort(shards.begin(), shards.end(), [](const ShardFolder& a, const ShardFolder& b) {
    return a.info.shard.index < b.info.shard.index;
  });
  for (std::size_t i = 1; i < shards.size(); ++i) {
    if (shards[i].info.shard != shards[i - 1].info.shard) continue;
    throw InputError(
        shards[i].path.string(),
        "is shard " + label(shards[i].info.shard) + " as is " + shards[i - 1].path.string(),
        "name only one of them");
  }
  if (const std::string lost = missing(shards); !lost.empty()) {
    throw InputError("--merge", "has no shard " + lost, run_again(lost));
  }
  return shards;
}

}  // namespace strata::shards
