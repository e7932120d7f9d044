// SPDX-License-Identifier: Apache-2.0
/// The tables of a comparison's report. models: those of comparison.json.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/pipeline/comparison.hpp"
#include "tools/report/html_report.hpp"

namespace strata::pipeline {

/// What decides, one row a model.
void add_model_table(const Comparison& comparison, const nlohmann::json& models,
                     report::HtmlReport& page);
/// Whether a pair differs by its test: in the mean error, or in how often it got lost.
[[nodiscard]] bool shows_difference(const PairedTest& test);
/// Models of which no two differ, so that each pair without a difference is in one of them; pairs
/// that are in one are left out of later ones where that is possible. Models in the order of
/// `comparison`. O(models^3).
[[nodiscard]] std::vector<std::vector<std::string>> alike_models(
    const Comparison& comparison, const std::vector<PairedTest>& tests);
/// Pairs with a difference, a row each; the others in a sentence. Nothing without pairs.
void add_pairs(const Comparison& comparison, const std::vector<PairedTest>& tests,
               report::HtmlReport& page);
/// One row a drive; nothing when there is only one.
void add_drives(const Comparison& comparison, report::HtmlReport& page);
/// Places that changed, with what each model made of them.
void add_changed_places(const Comparison& comparison, const nlohmann::json& models,
                        report::HtmlReport& page);
/// Error of every model in the same memory; nothing when that was not tried.
void add_equal_memory(const Comparison& comparison, report::HtmlReport& page);
/// The other measures: tails, heading, recovery, memory, time.
void add_more_measures(const Comparison& comparison, const nlohmann::json& models,
                       report::HtmlReport& page);
/// Transient obstacles and planning.
void add_robustness(const Comparison& comparison, const nlohmann::json& models,
                    report::HtmlReport& page);
/// What needs no ground truth.
void add_without_truth(const Comparison& comparison, const nlohmann::json& models,
                       report::HtmlReport& page);

}  // namespace strata::pipeline
