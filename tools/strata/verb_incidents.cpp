// SPDX-License-Identifier: Apache-2.0
/// `strata incidents`: what strata::IncidentRecorder has kept, and what came of it then.
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "components/incident_recorder/incident_folder.hpp"
#include "components/log/json_text.hpp"
#include "components/log/spooled_input.hpp"
#include "core/base/error.hpp"
#include "tools/strata/incident_replay.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/verbs.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {
namespace {

using incident_recorder::IncidentRecord;

struct IncidentsOptions {
  std::vector<std::string> words;  ///< DIR, or what to do and with what
  bool json = false;
  std::string maps;
  std::string out;
};

nlohmann::json as_json(const std::vector<IncidentRecord>& records) {
  nlohmann::json all = nlohmann::json::array();
  for (const IncidentRecord& record : records) {
    nlohmann::json one = nlohmann::json::parse(json_text(record));
    one["folder"] = record.folder.string();
    one["bytes"] = record.bytes;
    all.push_back(one);
  }
  return all;
}

void print(const std::vector<IncidentRecord>& records) {
  for (const IncidentRecord& record : records) {
    std::printf("%s\n", record.folder.string().c_str());
    for (const auto& reason : record.reasons) std::printf("  %s\n", reason.text.c_str());
    // They are counted at its end.
    std::printf("  %s%.1f MB%s%s\n",
                record.is_complete ? (counted(record.messages, "message") + ", ").c_str() : "",
                static_cast<double>(record.bytes) / 1e6,
                record.lost > 0 ? (", " + std::to_string(record.lost) + " lost").c_str() : "",
                record.is_complete ? "" : ", cut off: the process ended while it was written");
    for (const auto& file : record.files) {
      std::printf("  with %s as it was, %s\n", file.source.c_str(),
                  file.sha256.substr(0, 12).c_str());
    }
  }
}

std::vector<IncidentRecord> records_of(const std::string& folder) {
  log::require_reachable(folder);
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    throw InputError(folder, "is no folder",
                     "name the folder that strata::IncidentRecorder's `out` names");
  }
  return incident_recorder::read_records(folder);
}

IncidentRecord record_of(const std::string& folder) {
  log::require_reachable(folder);
  auto record = incident_recorder::read_record(folder);
  if (!record) {
    throw InputError(folder, "is no incident", "name one that `strata incidents DIR` lists");
  }
  return std::move(*record);
}

void run_incidents(const IncidentsOptions& options, VerbContext& context) {
  const bool has_action = options.words.size() == 2;
  const std::string action = has_action ? options.words.front() : "list";
  const std::string& place = options.words.back();
  if (action == "replay") {
    return replay_and_tell({place, options.maps}, options.out, context);
  }
  if (action != "list" && action != "show") {
    throw ConfigError(action, "is nothing to do with incidents", "say list, show or replay");
  }
  if (!options.out.empty() || !options.maps.empty()) {
    throw ConfigError("--out and --maps", "are for replay", "leave them out");
  }
  const auto records = action == "show" ? std::vector{record_of(place)} : records_of(place);
  if (options.json) {
    std::cout << log::json_text(as_json(records));
    return;
  }
  if (context.options.quiet) return;
  print(records);
  if (action == "list") {
    std::printf(
        "%s; look into one with `strata info`, play it with `strata play`, have its poses "
        "found again with `strata incidents replay`\n",
        counted(records.size(), "incident").c_str());
  }
  std::fflush(stdout);
}

}  // namespace

void add_incidents(CLI::App& app, VerbContext& context) {
  const auto [verb, options] =
      add_verb<IncidentsOptions>(app, context, "incidents", "what an incident recorder has kept",
                                 "strata incidents incidents --json\n"
                                 "  strata incidents replay incidents/2026-11-25T12-40-03Z_lost",
                                 run_incidents);
  verb->add_option("WHAT", options->words,
                   "DIR: the folder of incidents; show INCIDENT: one of them; replay INCIDENT: its "
                   "localizers' poses again, compared bit by bit")
      ->required()
      ->expected(1, 2);
  verb->add_option("--maps", options->maps,
                   "replay: the maps in use then, where the incident has no copy");
  verb->add_option("--out", options->out, "replay: folder for the poses");
  add_force(*verb, context);
  verb->add_flag("--json", options->json, "what is in each incident.json, with folder and bytes");
}

}  // namespace strata::tools
