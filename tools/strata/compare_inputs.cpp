// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/compare_inputs.hpp"

#include <filesystem>
#include <sstream>

#include "tools/shards/fingerprint.hpp"

namespace strata::tools {
namespace {

/// Every digit.
std::string text_of(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

std::string names_of(const std::vector<std::string>& paths) {
  std::string names;
  for (const std::string& path : paths) {
    names += std::filesystem::path(path).filename().string() + " ";
  }
  return names;
}

}  // namespace

shards::ShardInfo shard_info_of(const CompareOptions& options, const std::string& settings,
                                const shards::Shard& shard, const VerbContext& context) {
  shards::ShardInfo info = shards::shard_info(kCompareJob, shard, STRATA_VERSION);
  const pipeline::RunsInput& input = options.input;
  info.same["settings"] = settings;
  info.same["list of logs"] = names_of(input_of(options).logs);
  info.same["number of logs to learn from"] = std::to_string(options.train.size());
  info.same["--folds"] = std::to_string(options.folds);
  info.same["--buildings"] = options.buildings ? "yes" : "no";
  info.same["--seeds"] = std::to_string(options.seeds);
  info.same["--seed"] = std::to_string(context.options.seed);
  info.same["--via"] = options.via;
  info.same["--peers"] = options.peers ? "yes" : "no";
  info.same["--train-until"] =
      options.train_until_s ? text_of(*options.train_until_s) : std::string();
  info.same["--from"] = text_of(input.from_s);
  info.same["--to"] = text_of(input.to_s);
  info.same["--truth-offset"] = text_of(input.truth_offset_s);
  info.same["--no-odometry"] = input.use_odometry ? "no" : "yes";
  info.same["--odometry-lag"] =
      input.odometry_lag_s ? text_of(*input.odometry_lag_s) : std::string();
  info.same["--max-range"] = text_of(input.max_range_m);
  info.same["--min-height"] = text_of(input.cloud.min_height_m);
  info.same["--max-height"] = text_of(input.cloud.max_height_m);
  std::string topics;
  for (const std::string& topic : input.scan_topics) topics += topic + " ";
  info.same["--scan-topic"] = topics;
  if (!options.map.empty()) {
    info.same["--map"] = shards::fingerprint(options.map);
  }
  return info;
}

void add_inputs(const pipeline::RunsInput& input, std::size_t building, shards::ShardInfo& info) {
  const std::string prefix = building == 0 ? "" : "building " + std::to_string(building + 1) + ", ";
  const auto add = [&](const char* what, const std::vector<std::string>& files) {
    for (std::size_t i = 0; i < files.size(); ++i) {
      // A topic of a bag stands behind a colon.
      std::string path = files[i];
      if (!std::filesystem::exists(path)) path = path.substr(0, path.rfind(':'));
      info.inputs[prefix + what + " " + std::to_string(i + 1)] = shards::fingerprint(path);
    }
  };
  add("log", input.logs);
  add("file of poses", input.poses);
  add("file of truth", input.truths);
}

}  // namespace strata::tools
