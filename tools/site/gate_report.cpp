// SPDX-License-Identifier: Apache-2.0
#include "tools/site/gate_report.hpp"

#include <string>

#include "tools/pipeline/localize_picture.hpp"
#include "tools/report/html_report.hpp"
#include "tools/report/map_picture.hpp"

namespace strata::site {
namespace {

using nlohmann::json;

constexpr int kMapPixels = 900;

json to_json(const Drive& drive) {
  return {{"explained", drive.explained},
          {"contradicted", drive.contradicted},
          {"lost", drive.lost},
          {"score", drive.score},
          {"error_m", drive.error_m ? json(*drive.error_m) : json(nullptr)}};
}

json to_json(const MapShift& shift, const char* name) {
  const Pose2& pose = shift.from_moved;
  return {{name, {pose.x, pose.y, pose.theta}},
          {"shift_m", shift.shift_m},
          {"turn_rad", shift.turn_rad},
          {"common_walls", shift.common_walls}};
}

std::string line_of(const GateCheck& check) {
  return (check.log.empty() ? "" : check.log + ": ") + check.text;
}

/// Both maps cover the same rectangle, so that a slider can be drawn between them.
report::Image draw(const ReflectionGrid& map, const CellRect& rect, const Drive* drive) {
  report::MapPicture picture = report::draw_map(map, rect, kMapPixels);
  if (drive != nullptr) {
    for (const pipeline::FittedScan& scan : drive->fit.scans) {
      const Eigen::Vector2i at = picture.pixel(scan.map_from_robot.translation());
      picture.image.dot(at.x(), at.y(), 1, pipeline::color_of(scan));
    }
  }
  return picture.image;
}

void draw_all(report::HtmlReport& page, const GateTask& task, const GateReport& report) {
  const ReflectionGrid candidate = maps::read_maps(task.candidate).filtered;
  CellRect rect = report::known_rect(candidate);
  if (!task.active) {
    page.picture("map", draw(candidate, rect, nullptr), "the map", "the first version");
    return;
  }
  const ReflectionGrid active = maps::read_maps(*task.active).filtered;
  rect = rect.united(report::known_rect(active));
  page.heading("The maps");
  page.before_after("maps", draw(active, rect, nullptr), draw(candidate, rect, nullptr),
                    "active version", "candidate", "walls as the beam filter left them");
  for (std::size_t i = 0; i < report.logs.size(); ++i) {
    const GateLog& log = report.logs[i];
    page.heading(log.log);
    if (!log.active) {
      page.paragraph(log.passed_over);
      continue;
    }
    page.before_after("drive" + std::to_string(i), draw(active, rect, &*log.active),
                      draw(candidate, rect, &log.candidate), "active version", "candidate",
                      "where the robot was found; green: its scans fit, red: they do not, blue: "
                      "the map knows too little");
  }
}

}  // namespace

json to_json(const GateReport& report) {
  json checks = json::array();
  for (const GateCheck& check : report.checks) {
    checks.push_back(
        {{"name", check.name}, {"log", check.log}, {"passed", check.passed}, {"text", check.text}});
  }
  json logs = json::array();
  for (const GateLog& log : report.logs) {
    json one{{"log", log.log}, {"passed_over", log.passed_over}};
    if (log.passed_over.empty()) one["candidate"] = to_json(log.candidate);
    if (log.active) one["active"] = to_json(*log.active);
    logs.push_back(one);
  }
  json all{{"passed", report.passed()}, {"model", report.model}, {"checks", checks}, {"logs", logs},
           {"shift", nullptr},          {"drift", nullptr}};
  if (report.shift) all["shift"] = to_json(*report.shift, "candidate_from_active");
  if (report.drift) all["drift"] = to_json(*report.drift, "candidate_from_first");
  return all;
}

std::string to_text(const GateReport& report) {
  std::string text;
  for (const GateCheck& check : report.checks) {
    text +=
        (check.passed ? "  ok      " : "  FAILED  ") + check.name + "  " + line_of(check) + "\n";
  }
  for (const GateLog& log : report.logs) {
    if (!log.passed_over.empty()) {
      text += "  -       " + log.log + " says nothing: " + log.passed_over + "\n";
    }
  }
  if (report.logs.empty()) text += "  -       no recording was driven; --log gives one\n";
  return text;
}

std::string in_short(const GateReport& report) {
  std::string text;
  for (const GateCheck& check : report.checks) {
    if (!check.passed) text += (text.empty() ? "" : "; ") + check.name + ": " + line_of(check);
  }
  if (!report.passed()) return text;
  return "checked, " + (report.logs.empty()
                            ? std::string("without a recording")
                            : "on " + std::to_string(report.logs.size()) +
                                  (report.logs.size() == 1 ? " recording" : " recordings"));
}

void write_gate_report(const std::filesystem::path& folder, const std::string& title,
                       const GateTask& task, const GateReport& report) {
  report::HtmlReport page(folder, title);
  page.verdict(report.passed() ? "May be activated: " + in_short(report)
                               : "Refused: " + in_short(report));
  report::Table table{{"", "what", "found"}, {}, "what was looked at"};
  for (const GateCheck& check : report.checks) {
    table.rows.push_back({check.passed ? "ok" : "FAILED", check.name, line_of(check)});
  }
  page.table(table);
  draw_all(page, task, report);
  page.write();
  report::write_file(folder / "check.json", to_json(report).dump(2) + "\n");
}

}  // namespace strata::site
