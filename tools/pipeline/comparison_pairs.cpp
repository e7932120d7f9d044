// SPDX-License-Identifier: Apache-2.0
/// Which models differ by more than chance: said once of those that do not.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tools/pipeline/comparison_cells.hpp"
#include "tools/pipeline/comparison_tables.hpp"
#include "tools/pipeline/over_runs.hpp"

namespace strata::pipeline {
namespace {

using report::fixed;

bool differs_in_lost_runs(const PairedTest& test) { return test.p_lost < kAlpha; }

using NamePairs = std::set<std::pair<std::string, std::string>>;

std::pair<std::string, std::string> in_order(const std::string& one, const std::string& other) {
  return std::minmax(one, other);
}

/// Two models and all others that are alike to them and to each other, in order.
std::vector<std::string> group_around(const std::string& first, const std::string& second,
                                      const Comparison& comparison, const NamePairs& alike) {
  std::set<std::string> group{first, second};
  for (const ModelResult& model : comparison.models) {
    const bool joins = std::all_of(group.begin(), group.end(), [&](const std::string& other) {
      return alike.contains(in_order(model.model, other));
    });
    if (joins) group.insert(model.model);
  }
  std::vector<std::string> ordered;
  for (const ModelResult& model : comparison.models) {
    if (group.contains(model.model)) ordered.push_back(model.model);
  }
  return ordered;
}

/// "a, b and c".
std::string listed(const std::vector<std::string>& names) {
  std::string text = names.front();
  for (std::size_t i = 1; i < names.size(); ++i) {
    text += (i + 1 < names.size() ? ", " : " and ") + names[i];
  }
  return text;
}

/// The farthest from 0 that an interval of a difference between two of them reaches [m].
double widest_m(const std::vector<std::string>& models, const std::vector<PairedTest>& tests) {
  const auto has = [&](const std::string& name) {
    return std::find(models.begin(), models.end(), name) != models.end();
  };
  double widest = 0.0;
  for (const PairedTest& test : tests) {
    if (!has(test.better) || !has(test.worse)) continue;
    widest = std::max({widest, std::abs(test.ci95_m.low), std::abs(test.ci95_m.high)});
  }
  return widest;
}

std::string shown_in(const PairedTest& test) {
  if (!test.significant) return "lost runs";
  return differs_in_lost_runs(test) ? "mean error, lost runs" : "mean error";
}

report::Table table_of_differences() {
  report::Table table;
  table.header = {"lower error",         "higher error",
                  "difference shown in", "difference",
                  "95% interval",        "p (Holm)",
                  "Cliff's delta",       "lost: only the first, only the second",
                  "p lost (Holm)"};
  table.caption = "Differences of the mean error in metres, drive by drive and seed by seed.";
  table.terms = {
      {"difference shown",
       "in the mean error when both its interval (bootstrap, BCa) and its p (Wilcoxon's "
       "signed-rank test) say so; in lost runs by p lost (McNemar's exact test)"},
      {"95% interval",
       "confidence interval: were everything repeated, 19 of 20 such intervals would hold the true "
       "difference; one that holds 0 shows none"},
      {"p (Holm)",
       "how often chance alone would show as much, made larger by Holm's correction because among "
       "many pairs some differ by chance; below " +
           fixed(kAlpha, 2) + " counts"},
      {"Cliff's delta",
       "how often a run of the second has a larger error than one of the first, less how often a "
       "smaller one: 1 is always, 0 even"},
      {"lost", "runs in which only the one of the two stayed above 1 m for 5 s or longer"}};
  return table;
}

}  // namespace

bool shows_difference(const PairedTest& test) {
  return test.significant || differs_in_lost_runs(test);
}

std::vector<std::vector<std::string>> alike_models(const Comparison& comparison,
                                                   const std::vector<PairedTest>& tests) {
  NamePairs alike;
  for (const PairedTest& test : tests) {
    if (!shows_difference(test)) alike.insert(in_order(test.better, test.worse));
  }
  NamePairs unsaid = alike;
  std::vector<std::vector<std::string>> groups;
  for (const ModelResult& first : comparison.models) {
    for (const ModelResult& second : comparison.models) {
      if (!unsaid.contains(in_order(first.model, second.model))) continue;
      groups.push_back(group_around(first.model, second.model, comparison, alike));
      for (const std::string& one : groups.back()) {
        for (const std::string& other : groups.back()) unsaid.erase(in_order(one, other));
      }
    }
  }
  return groups;
}

void add_pairs(const Comparison& comparison, const std::vector<PairedTest>& tests,
               report::HtmlReport& page) {
  if (tests.empty()) return;
  page.heading("More than chance?");
  report::Table table = table_of_differences();
  for (const PairedTest& test : tests) {
    if (!shows_difference(test)) continue;
    table.rows.push_back(
        {test.better, test.worse, shown_in(test), fixed(test.mean_difference_m, 3),
         interval(test.ci95_m, 3), p_value(test.p), fixed(test.cliffs_delta, 2),
         std::to_string(test.lost_only_better) + ", " + std::to_string(test.lost_only_worse),
         p_value(test.p_lost)});
  }
  if (!table.rows.empty()) page.table(table);
  for (const std::vector<std::string>& group : alike_models(comparison, tests)) {
    page.paragraph("No difference shown between " + listed(group) +
                   ", neither in the mean error nor in lost runs. The 95% intervals of the mean "
                   "error's differences reach to " +
                   fixed(widest_m(group, tests), 3) + " m.");
  }
  page.paragraph("The numbers of every pair are in comparison.json.");
}

}  // namespace strata::pipeline
