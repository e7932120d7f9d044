// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/score_report.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <map>
#include <utility>

#include "tools/laboratory/experiments/score_fit.hpp"
#include "tools/laboratory/experiments/score_samples.hpp"
#include "tools/report/plot.hpp"
#include "tools/simulate/random_office.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::experiments {
namespace {

constexpr const char* kModels[] = {"patch", "filtered"};
constexpr int kTimes = 4;
constexpr double kShortReach_m = 4.0;
constexpr double kSureScore = 0.9;
constexpr std::size_t kBins = 10;
/// Of the sure ones, so many may be wrong where weights are learned: three quarters of what is
/// promised elsewhere.
constexpr double kWrongShare = 0.0075;

using Samples = std::vector<ScoreSample>;

bool is_wrong(const ScoreSample& sample) { return sample.error_m > kWrongPose_m; }

/// Numbers of scans, all or some of them.
struct Counts {
  std::size_t scans = 0;
  std::size_t wrong = 0;
  std::size_t sure = 0;
  std::size_t sure_and_wrong = 0;
  std::size_t right_and_lost = 0;
  std::size_t wrong_and_lost = 0;

  void add(const ScoreSample& sample) {
    const bool wrong_one = is_wrong(sample);
    const bool sure_one = sample.score >= kSureScore;
    ++scans;
    wrong += wrong_one ? 1 : 0;
    sure += sure_one ? 1 : 0;
    sure_and_wrong += sure_one && wrong_one ? 1 : 0;
    (wrong_one ? wrong_and_lost : right_and_lost) += sample.is_lost ? 1 : 0;
  }
};

void print(const std::string& name, const Samples& samples) {
  Counts all;
  Counts tracked;
  for (const ScoreSample& sample : samples) {
    all.add(sample);
    if (sample.is_tracked) tracked.add(sample);
  }
  const auto share = [](std::size_t part, std::size_t of) {
    return of == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(of);
  };
  for (const auto& [what, c] : {std::pair("all drives", all), std::pair("tracked", tracked)}) {
    std::printf(
        "%s, %s: %zu scans, %.1f%% wrong; score >= 0.9: %zu (%.1f%% of the right ones), %.2f%% of "
        "them wrong; called lost: %zu of %zu right, %zu of %zu wrong\n",
        name.c_str(), what, c.scans, share(c.wrong, c.scans), c.sure,
        share(c.sure - c.sure_and_wrong, c.scans - c.wrong), share(c.sure_and_wrong, c.sure),
        c.right_and_lost, c.scans - c.wrong, c.wrong_and_lost, c.wrong);
  }
  std::fflush(stdout);
}

/// Share of right ones in each bin of the score, against the mean score there.
report::Series reliability(const std::string& name, const Samples& samples) {
  std::array<std::array<double, 3>, kBins> sums{};  // scans, scores, right ones
  for (const ScoreSample& sample : samples) {
    const auto bin = static_cast<std::size_t>(sample.score * static_cast<double>(kBins));
    auto& sum = sums[std::min(bin, kBins - 1)];
    sum[0] += 1.0;
    sum[1] += sample.score;
    sum[2] += is_wrong(sample) ? 0.0 : 1.0;
  }
  report::Series series{name, {}, {}};
  for (const auto& [scans, scores, right] : sums) {
    if (scans < 1.0) continue;
    series.x.push_back(scores / scans);
    series.y.push_back(right / scans);
  }
  return series;
}

class Report {
 public:
  void add(const std::string& group, const VerdictWorld& world) {
    for (const char* model : kModels) {
      Samples samples = score_samples(world, model, kTimes);
      for (ScoreSample& sample : samples) sample.drive += drives_;
      drives_ += samples.empty() ? 0 : samples.back().drive;
      auto& of_model = by_model_[group + ", " + model];
      of_model.insert(of_model.end(), samples.begin(), samples.end());
      auto& of_group = by_group_[group];
      of_group.insert(of_group.end(), samples.begin(), samples.end());
    }
  }
  void finish(const std::filesystem::path& out) const {
    report::LinePlot plot;
    plot.title = "Is the score what it says?";
    plot.x_label = "mean score of a tenth";
    plot.y_label = "share within 0.5 m";
    plot.from_zero = true;
    plot.y_max = 1.0;
    plot.points = true;
    plot.series.push_back({"as it should be", {0.0, 1.0}, {0.0, 1.0}});
    std::vector<Samples> groups;
    for (const auto& [name, samples] : by_model_) print(name, samples);
    for (const auto& [name, samples] : by_group_) {
      plot.series.push_back(reliability(name, samples));
      groups.push_back(samples);
    }
    std::filesystem::create_directories(out);
    report::save_png(plot, out / "reliability.png");
    std::ofstream(out / "reliability.csv") << report::to_csv(plot);
    const ScoreWeights learned = fit_score(groups, kWrongShare);
    std::printf("weights learned from these:");
    for (const double weight : learned.weights) std::printf(" %.2f,", weight);
    std::printf(" bias %.2f, caution %.2f\n", learned.bias, learned.caution);
  }

 private:
  std::map<std::string, Samples> by_model_;
  std::map<std::string, Samples> by_group_;
  std::size_t drives_ = 0;
};

}  // namespace

void report_score(const ScoreReportOptions& options) {
  Report report;
  for (std::size_t i = 0; i < options.logs.size(); ++i) {
    const VerdictWorld world = world_of_log(options.logs[i], options.poses[i]);
    report.add(world.name, world);
  }
  if (!options.runs.empty()) {
    for (const VerdictWorld& world : worlds_of_runs(options.runs)) report.add("Wean Hall", world);
  }
  for (const std::string& name : options.scenario_names) {
    const auto scenario = simulate::load_scenario(options.scenarios + "/" + name);
    report.add(name, world_of_scenario(name, scenario, options.first_office));
  }
  for (int i = 0; i < options.offices; ++i) {
    const std::uint64_t office = options.first_office + static_cast<std::uint64_t>(i);
    simulate::ScenarioConfig scenario = simulate::random_office(office, {4, true, 2});
    const bool is_short = office % 2 == 0;
    if (is_short) scenario.laser.range_max_m = kShortReach_m;
    report.add(is_short ? "offices, 4 m" : "offices, 12 m",
               world_of_scenario("office " + std::to_string(office), scenario, 100 + office));
  }
  report.finish(options.out);
}

}  // namespace strata::experiments
