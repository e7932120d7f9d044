// SPDX-License-Identifier: Apache-2.0
/// `strata incidents DIR`: what strata::IncidentRecorder has kept.
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
#include "tools/strata/verbs.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {
namespace {

using incident_recorder::IncidentRecord;

struct Options {
  std::string folder;
  bool json = false;
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
    std::printf("  %s, %.1f MB%s%s\n", counted(record.messages, "message").c_str(),
                static_cast<double>(record.bytes) / 1e6,
                record.lost > 0 ? (", " + std::to_string(record.lost) + " lost").c_str() : "",
                record.is_complete ? "" : ", cut off: the process ended while it was written");
    for (const auto& file : record.files) {
      std::printf("  with %s as it was, %s\n", file.source.c_str(),
                  file.sha256.substr(0, 12).c_str());
    }
  }
}

void run(const Options& options, VerbContext& context) {
  log::require_reachable(options.folder);
  std::error_code error;
  if (!std::filesystem::is_directory(options.folder, error)) {
    throw InputError(options.folder, "is no folder",
                     "name the folder that strata::IncidentRecorder's `out` names");
  }
  const auto records = incident_recorder::read_records(options.folder);
  if (options.json) {
    std::cout << log::json_text(as_json(records));
    return;
  }
  if (context.options.quiet) return;
  print(records);
  std::printf("%s; look into one with `strata info`, play it with `strata play`\n",
              counted(records.size(), "incident").c_str());
  std::fflush(stdout);
}

}  // namespace

void add_incidents(CLI::App& app, VerbContext& context) {
  const auto [verb, options] =
      add_verb<Options>(app, context, "incidents", "what an incident recorder has kept",
                        "strata incidents incidents --json", run);
  verb->add_option("DIR", options->folder, "folder of incidents")->required();
  verb->add_flag("--json", options->json, "what is in each incident.json, with folder and bytes");
}

}  // namespace strata::tools
