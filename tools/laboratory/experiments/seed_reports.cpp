// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/seed_reports.hpp"

#include <iostream>
#include <map>
#include <utility>
#include <vector>

namespace strata::experiments {
namespace {

void print(const std::string& name, const Judgement& j, int whole, int seeds) {
  std::cout << name << ": " << j.found_objects << " of " << j.changed_objects
            << " changed objects found, " << j.submaps << " sub-maps, " << j.false_submaps
            << " false; configurations extra " << j.extra_configurations << ", missing "
            << j.missing_configurations << "; sequences in the right one " << j.right_sequences
            << " of " << j.sequences << "; seeds without any mistake " << whole << " of " << seeds
            << "\n";
}

std::string unit_name(const std::string& name, std::uint64_t seed) {
  return name + " seed " + std::to_string(seed);
}

}  // namespace

void report_learning(const std::string& name, const Seeds& seeds, shards::Units& units,
                     const std::function<Judgement(std::uint64_t)>& one) {
  Judgement sum;
  int whole = 0;
  for (int i = 0; i < seeds.count; ++i) {
    const std::uint64_t seed = seeds.first + static_cast<std::uint64_t>(i);
    const auto j = units.of<Judgement>(unit_name(name, seed), [&] { return one(seed); });
    const bool is_whole = j.found_objects == j.changed_objects && j.false_submaps == 0 &&
                          j.extra_configurations == 0 && j.missing_configurations == 0;
    whole += is_whole ? 1 : 0;
    sum += j;
  }
  print(name, sum, whole, seeds.count);
}

void report_localizing(const std::string& name, const Seeds& seeds, shards::Units& units,
                       const std::function<Outcomes(std::uint64_t)>& one) {
  struct Sum {
    DayOutcome mean;
    int lost = 0;
    int failed = 0;
  };
  using Entries = std::vector<std::pair<std::string, DayOutcome>>;
  std::map<std::string, Sum> sums;
  for (int i = 0; i < seeds.count; ++i) {
    const std::uint64_t seed = seeds.first + static_cast<std::uint64_t>(i);
    const auto entries = units.of<Entries>(unit_name(name, seed), [&] {
      const Outcomes outcomes = one(seed);
      return Entries(outcomes.begin(), outcomes.end());
    });
    for (const auto& [model, outcome] : entries) {
      Sum& sum = sums[model];
      sum.mean.error_m += outcome.error_m / seeds.count;
      sum.mean.changed_error_m += outcome.changed_error_m / seeds.count;
      sum.mean.final_error_m += outcome.final_error_m / seeds.count;
      sum.mean.failure_rate += outcome.failure_rate / seeds.count;
      sum.mean.entries += outcome.entries;
      sum.mean.recognized += outcome.recognized;
      sum.lost += outcome.is_lost ? 1 : 0;
      sum.failed += outcome.final_error_m > 1.0 ? 1 : 0;
    }
  }
  for (const auto& [model, sum] : sums) {
    std::cout << name << " " << model << ": error " << sum.mean.error_m << " m, where it changes "
              << sum.mean.changed_error_m << " m, at the end " << sum.mean.final_error_m
              << " m; failure rate " << sum.mean.failure_rate << ", lost " << sum.lost
              << ", ended wrong " << sum.failed << " of " << seeds.count
              << "; true configuration known within 20 updates of " << sum.mean.recognized << " of "
              << sum.mean.entries << " entries\n";
  }
}

}  // namespace strata::experiments
