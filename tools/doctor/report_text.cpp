// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "tools/doctor/examination.hpp"

namespace strata::doctor {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text.empty() ? "-" : text;
}

std::string rate_text(const TopicReport& topic) {
  if (topic.rate_hz <= 0.0) return "";
  char text[64];
  std::snprintf(text, sizeof text, "  %.1f Hz, %.1f kB/s", topic.rate_hz,
                topic.bytes_per_s / 1000.0);
  return text;
}

}  // namespace

std::string to_text(const Report& report, bool all) {
  std::string text = report.findings.empty() ? "no problem found\n" : "findings\n";
  for (const Finding& finding : report.findings) {
    text += std::string(finding.is_error ? "  error: " : "  note: ") + finding.place + ": " +
            finding.what + "; " + finding.advice + "\n";
  }
  text += std::to_string(report.participants.size()) +
          (report.participants.size() == 1 ? " participant\n" : " participants\n");
  for (const ParticipantReport& participant : report.participants) {
    text += "  " + participant.guid + "  " + participant.vendor +
            "  nodes: " + joined(participant.nodes) + "\n";
  }
  const auto hidden = static_cast<std::size_t>(
      all ? 0
          : std::count_if(report.topics.begin(), report.topics.end(),
                          [](const TopicReport& topic) { return topic.is_plumbing; }));
  const std::size_t shown = report.topics.size() - hidden;
  text +=
      std::to_string(shown) + (shown == 1 ? " topic" : " topics") +
      (hidden > 0 ? ", and " + std::to_string(hidden) + " of services and the like (--all)" : "") +
      "\n";
  for (const TopicReport& topic : report.topics) {
    if (topic.is_plumbing && !all) continue;
    text += "  " + topic.name + "  " + topic.type + rate_text(topic) + "\n    from " +
            joined(topic.writers) + "\n    to   " + joined(topic.readers) + "\n";
  }
  return text;
}

std::string to_json(const Report& report) {
  nlohmann::ordered_json json;
  json["participants"] = nlohmann::ordered_json::array();
  for (const ParticipantReport& participant : report.participants) {
    json["participants"].push_back({{"guid", participant.guid},
                                    {"vendor", participant.vendor},
                                    {"enclave", participant.enclave},
                                    {"nodes", participant.nodes}});
  }
  json["topics"] = nlohmann::ordered_json::array();
  for (const TopicReport& topic : report.topics) {
    json["topics"].push_back({{"name", topic.name},
                              {"type", topic.type},
                              {"writers", topic.writers},
                              {"readers", topic.readers},
                              {"rate_hz", topic.rate_hz},
                              {"bytes_per_s", topic.bytes_per_s},
                              {"plumbing", topic.is_plumbing}});
  }
  json["findings"] = nlohmann::ordered_json::array();
  for (const Finding& finding : report.findings) {
    json["findings"].push_back({{"level", finding.is_error ? "error" : "note"},
                                {"place", finding.place},
                                {"what", finding.what},
                                {"advice", finding.advice}});
  }
  // Others name their nodes as they like: what is no UTF-8 is replaced.
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace strata::doctor
