// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/compare_job.hpp"

#include <filesystem>
#include <utility>

#include "components/log/map_file.hpp"
#include "components/maps/map_models.hpp"
#include "core/base/error.hpp"
#include "tools/strata/dds_localize.hpp"
#include "tools/strata/peer_localize.hpp"
#include "tools/strata/run_options.hpp"
#include "tools/strata/verb_config.hpp"

namespace strata::tools {
namespace {

std::string join(const std::vector<std::string>& names) {
  std::string joined;
  for (const std::string& name : names) joined += (joined.empty() ? "" : " ") + name;
  return joined;
}

std::vector<pipeline::Split> make_splits(const CompareOptions& options, const pipeline::Runs& runs,
                                         const std::vector<std::string>& logs,
                                         const pipeline::CompareProtocol& protocol) {
  if (options.folds > 0) return pipeline::make_folds(runs, logs, options.folds);
  if (!options.train.empty()) {
    return {pipeline::split_by_run(runs, logs, static_cast<int>(options.train.size()))};
  }
  const double length_s = pipeline::elapsed_seconds(runs.observations).back();
  return {pipeline::split_by_time(runs, join(logs),
                                  options.train_until_s.value_or(protocol.train_share * length_s))};
}

}  // namespace

std::vector<std::uint64_t> seeds_of(const CompareOptions& options, std::uint64_t first) {
  std::vector<std::uint64_t> seeds;
  for (int i = 0; i < options.seeds; ++i) seeds.push_back(first + static_cast<std::uint64_t>(i));
  return seeds;
}

void require_one_way(const CompareOptions& options) {
  const bool divided = !options.train.empty() || !options.test.empty();
  if (divided && !options.input.logs.empty()) {
    throw InputError("LOG", "is given beside --train and --test", "use one or the other");
  }
  if (divided && (options.train.empty() || options.test.empty())) {
    throw InputError("--train and --test", "belong together", "give both");
  }
  if (!divided && options.input.logs.empty()) {
    throw InputError("LOG", "is missing", "give a log, or --train and --test");
  }
  if (options.buildings && divided) {
    throw InputError("--buildings", "divides each log by itself", "leave out --train and --test");
  }
  if (options.folds > 0 && (divided || options.train_until_s)) {
    throw InputError("--folds", "divides the logs by itself",
                     "leave out --train, --test and --train-until");
  }
}

pipeline::CompareConfig compare_config_of(const CompareOptions& options, VerbContext& context) {
  auto config = read_config<pipeline::CompareConfig>(context);
  if (!options.models.empty()) config.protocol.models = options.models;
  if (!options.map.empty() && options.models.empty()) {
    for (const auto& model : maps::map_models().all()) {
      if (!model->is_learned()) config.protocol.models.push_back(model->shown_name());
    }
  }
  return config;
}

PreparedComparison prepare_comparison(const CompareOptions& options,
                                      const pipeline::RunsInput& input,
                                      const pipeline::CompareConfig& config, VerbContext& context) {
  pipeline::RunsInput reading = with_config(input, config.log);
  reading.needs_ros_stamps = options.via == "dds";
  PreparedComparison prepared{pipeline::read_runs(reading, context.progress()), {}};
  const pipeline::Runs& runs = prepared.runs;
  note_reports(context, runs);
  if (runs.observations.empty()) {
    throw InputError(join(input.logs), "holds no scan in that time", "check --from and --to");
  }
  pipeline::CompareJob& job = prepared.job;
  job.log = join(input.logs);
  job.splits = make_splits(options, runs, input.logs, config.protocol);
  job.seeds = seeds_of(options, context.options.seed);
  job.threads = context.options.threads;
  job.jobs = options.jobs;
  job.progress = context.progress();
  job.via = options.via;
  if (options.via == "dds") job.localize_with = localize_over_dds(context, options.out);
  if (options.peers) job.peers = peers_of_this_build(context, options.out);
  if (!options.map.empty()) job.given_map = log::read_map(options.map);
  return prepared;
}

pipeline::RunsInput building_input(const CompareOptions& options, std::size_t i) {
  pipeline::RunsInput input = options.input;
  input.logs = {options.input.logs[i]};
  for (auto* files : {&input.poses, &input.truths}) {
    if (files->empty()) continue;
    if (files->size() != options.input.logs.size()) {
      throw InputError("--poses and --truth", "are not given once per log",
                       "give them in the order of the logs");
    }
    *files = {(*files)[i]};
  }
  return input;
}

std::string building_folder(const CompareOptions& options, std::size_t i) {
  const std::string name = std::filesystem::path(options.input.logs[i]).filename().string();
  return std::to_string(i + 1) + "_" + name.substr(0, name.find('.'));
}

}  // namespace strata::tools
