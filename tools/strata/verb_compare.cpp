// SPDX-License-Identifier: Apache-2.0
/// `strata compare`: which map model localizes best in this building?
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "components/settings/settings.hpp"
#include "core/base/error.hpp"
#include "tools/pipeline/compare.hpp"
#include "tools/pipeline/comparison_report.hpp"
#include "tools/strata/run_options.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/verbs.hpp"

namespace strata::tools {
namespace {

struct Options {
  pipeline::RunsInput input;
  std::vector<std::string> train;
  std::vector<std::string> test;
  std::vector<std::string> models;
  std::string out;
  std::optional<double> train_until_s;
  int seeds = 20;
};

std::vector<std::uint64_t> seeds_of(const Options& options, std::uint64_t first) {
  std::vector<std::uint64_t> seeds;
  for (int i = 0; i < options.seeds; ++i) seeds.push_back(first + static_cast<std::uint64_t>(i));
  return seeds;
}

void require_one_way(const Options& options) {
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
}

std::size_t scans_before_run(const std::vector<Observation>& observations, int run) {
  std::size_t count = 0;
  for (const Observation& observation : observations) count += observation.run < run ? 1 : 0;
  return count;
}

void run_compare(const Options& options, VerbContext& context) {
  require_one_way(options);
  auto config = settings::read_config<pipeline::CompareConfig>(load_config(context.options),
                                                               config_place(context.options));
  if (!options.models.empty()) config.protocol.models = options.models;
  pipeline::RunsInput input = options.input;
  for (const auto* logs : {&options.train, &options.test}) {
    input.logs.insert(input.logs.end(), logs->begin(), logs->end());
  }
  const pipeline::Runs runs = pipeline::read_runs(input, context.progress());
  note_reports(context, runs);
  const auto seeds = seeds_of(options, context.options.seed);
  std::string name;
  for (const std::string& log : input.logs) name += (name.empty() ? "" : " ") + log;
  const int threads = context.options.threads;
  const pipeline::CompareOutcome outcome =
      options.train.empty()
          ? pipeline::compare(runs, name, config, options.train_until_s, seeds, threads,
                              context.progress())
          : pipeline::compare_split(
                runs, scans_before_run(runs.observations, static_cast<int>(options.train.size())),
                name, config, seeds, threads, context.progress());
  OutputDirectory out(options.out, context.staged());
  pipeline::write_report(outcome, settings::write_yaml(config), out.path());
  out.commit();
  const auto tests = pipeline::paired_tests(outcome.comparison);
  std::cout << pipeline::verdict(outcome.comparison, tests) << '\n';
  context.note("report: " + options.out + "/report.html");
}

}  // namespace

void add_compare(CLI::App& app, VerbContext& context) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(app, context, "compare", "which map localizes best in this building?",
                            "strata compare week.clf --seeds 20 --out comparison",
                            [options, &context] { run_compare(*options, context); });
  verb->add_option("LOG", options->input.logs, "learn on the first part, localize on the rest");
  verb->add_option("--train", options->train, "logs to learn from");
  verb->add_option("--test", options->test, "logs to localize in");
  verb->add_option("--out", options->out, "folder for report.html, comparison.json and figures")
      ->required();
  verb->add_option("--models", options->models, "models to compare (comma separated)")
      ->delimiter(',');
  verb->add_option("--train-until", options->train_until_s, "seconds that belong to learning");
  verb->add_option("--seeds", options->seeds, "runs of the localizer per model")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  add_run_options(*verb, options->input);
}

}  // namespace strata::tools
