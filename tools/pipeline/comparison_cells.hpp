// SPDX-License-Identifier: Apache-2.0
/// What stands in a cell of a comparison's tables. Values: those of comparison.json.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/pipeline/comparison.hpp"
#include "tools/report/html_report.hpp"
#include "tools/report/plot.hpp"
#include "tools/statistics/statistics.hpp"

namespace strata::pipeline {

inline constexpr const char* kNoValue = "-";

using CellRow = std::vector<std::string>;

inline std::string number(const nlohmann::json& value, int digits) {
  return value.is_null() ? kNoValue : report::fixed(value.get<double>(), digits);
}

inline std::string interval(const statistics::Interval& ci, int digits) {
  return report::fixed(ci.low, digits) + " to " + report::fixed(ci.high, digits);
}
/// ci: [low, high].
inline std::string interval(const nlohmann::json& ci, int digits) {
  return interval(statistics::Interval{ci[0].get<double>(), ci[1].get<double>()}, digits);
}

inline std::string percent(const nlohmann::json& share) {
  return share.is_null() ? kNoValue : report::fixed(100.0 * share.get<double>(), 1) + "%";
}

inline std::string p_value(double p) { return p < 1e-4 ? "< 0.0001" : report::fixed(p, 4); }

/// A field of an object that may be null.
inline nlohmann::json field(const nlohmann::json& object, const char* key) {
  return object.is_null() ? nlohmann::json(nullptr) : object[key];
}

inline std::string kilobytes(std::size_t bytes) {
  return report::fixed(static_cast<double>(bytes) / 1024.0, 0) + " kB";
}

/// The table with a row a model: its name, then what `cells` says of it and its figures.
template <typename Cells>
void add_model_rows(report::Table table, const Comparison& comparison, const nlohmann::json& models,
                    Cells cells, report::HtmlReport& page) {
  for (const ModelResult& model : comparison.models) {
    CellRow row = cells(model, models[model.model]);
    row.insert(row.begin(), model.model);
    table.rows.push_back(std::move(row));
  }
  page.table(table);
}

}  // namespace strata::pipeline
