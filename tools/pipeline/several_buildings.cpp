// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/several_buildings.hpp"

#include <cstddef>
#include <utility>

#include "core/base/error.hpp"
#include "tools/pipeline/comparison_report.hpp"
#include "tools/pipeline/comparison_tables.hpp"
#include "tools/pipeline/join_comparisons.hpp"
#include "tools/pipeline/over_runs.hpp"
#include "tools/report/html_report.hpp"

namespace strata::pipeline {
namespace {

using nlohmann::json;
using report::fixed;

void append_model(const ModelResult& from, std::size_t first_part, ModelResult& to) {
  to.map_bytes += from.map_bytes;
  to.resident_bytes += from.resident_bytes;
  append_drives(from, first_part, to);
}

void add_building_table(const std::vector<Building>& buildings, report::HtmlReport& page) {
  report::Table table;
  table.header = {"building", "drives"};
  table.caption =
      "Mean error in metres with its 95% interval over drives and seeds, one building a row. The "
      "number of the building is that of its folder, which holds a report of its own.";
  table.terms = {{"95% interval",
                  "confidence interval: were everything repeated, 19 of 20 such intervals would "
                  "hold the true mean"}};
  for (const ModelResult& model : buildings.front().comparison.models) {
    table.header.push_back(model.model);
  }
  for (const Building& building : buildings) {
    std::vector<std::string> row{building.folder, std::to_string(building.comparison.parts.size())};
    for (const ModelResult& model : building.comparison.models) {
      const statistics::Interval ci =
          statistics::bootstrap_mean(run_means(model), 0.95, kBootstrapSeed);
      row.push_back(fixed(mean_error_m(model), 3) + " (" + fixed(ci.low, 3) + " to " +
                    fixed(ci.high, 3) + ")");
    }
    table.rows.push_back(std::move(row));
  }
  page.table(table);
}

std::string sentence_of(const Building& building) {
  const Comparison& comparison = building.comparison;
  std::string text = building.folder + ": " + verdict(comparison, paired_tests(comparison));
  if (comparison.truth == TruthKind::kJointTrajectory) {
    text +=
        " (No ground truth here: errors are against a pseudo-truth, the trajectory that SLAM "
        "gives to the whole log.)";
  }
  return text;
}

}  // namespace

Comparison join(const std::vector<Building>& buildings) {
  Comparison joint;
  joint.via = buildings.front().comparison.via;
  joint.seeds = buildings.front().comparison.seeds;
  for (const ModelResult& model : buildings.front().comparison.models) {
    joint.models.emplace_back().model = model.model;
  }
  for (const Building& building : buildings) {
    const Comparison& one = building.comparison;
    joint.log += (joint.log.empty() ? "" : " ") + one.log;
    if (one.truth == TruthKind::kJointTrajectory) joint.truth = one.truth;
    const std::size_t first_part = joint.parts.size();
    for (TestPartInfo part : one.parts) {
      part.name = building.folder + (one.parts.size() > 1 ? ", " + part.name : std::string());
      joint.parts.push_back(std::move(part));
    }
    bool same = one.models.size() == joint.models.size();
    for (std::size_t m = 0; same && m < one.models.size(); ++m) {
      same = one.models[m].model == joint.models[m].model;
      if (same) append_model(one.models[m], first_part, joint.models[m]);
    }
    if (!same) {
      throw InputError(building.folder, "was compared with other models", "use the same for all");
    }
  }
  return joint;
}

json joint_json(const std::vector<Building>& buildings) {
  const Comparison joint = join(buildings);
  json result = to_json(joint, paired_tests(joint));
  result["buildings"] = json::array();
  for (const Building& building : buildings) {
    json one = to_json(building.comparison, paired_tests(building.comparison));
    one["folder"] = building.folder;
    result["buildings"].push_back(std::move(one));
  }
  return result;
}

void write_joint_report(const std::vector<Building>& buildings, const std::string& settings,
                        const std::filesystem::path& folder) {
  const Comparison joint = join(buildings);
  const std::vector<PairedTest> tests = paired_tests(joint);
  const json result = joint_json(buildings);
  report::HtmlReport page(folder, "Which map for these buildings?");
  page.verdict(verdict(joint, tests));
  page.paragraph("Over " + std::to_string(buildings.size()) +
                 " buildings together. Seeds of one building are alike: what holds in one and not "
                 "in another shows in the rows below, not in the sentence above.");
  add_building_table(buildings, page);
  page.heading("What each building says");
  for (const Building& building : buildings) {
    page.paragraph(sentence_of(building));
    page.link(std::filesystem::path(building.folder) / "report.html",
              "The report of " + building.folder);
  }
  page.heading("All drives together");
  add_model_table(joint, result["models"], page);
  add_pairs(joint, tests, page);
  add_drives(joint, page);
  add_changed_places(joint, result["models"], page);
  finish_report(joint, result, settings, folder, page);
}

}  // namespace strata::pipeline
