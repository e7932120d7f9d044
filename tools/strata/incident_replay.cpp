// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/incident_replay.hpp"

#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <set>

#include <nlohmann/json.hpp>

#include "components/convert/cdr.hpp"
#include "components/incident_recorder/incident_folder.hpp"
#include "components/log/bag.hpp"
#include "components/log/content_hash.hpp"
#include "core/base/error.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/words.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using incident_recorder::IncidentRecord;
using localizer::JournalReplay;
using localizer::RestorePoint;

/// "/robot1/localizer" of "/robot1/localizer/_journal"; nothing of another topic.
std::optional<std::string> owner_of(const std::string& topic, const char* name) {
  const std::string ending = std::string("/") + name;
  if (!topic.ends_with(ending)) return std::nullopt;
  return topic.substr(0, topic.size() - ending.size());
}

std::map<std::string, JournalReplay> read_journals(const fs::path& incident) {
  std::map<std::string, JournalReplay> journals;
  const auto bag = log::BagReader::open(incident);
  for (log::BagMessage message; bag->next(message);) {
    const std::string& topic = bag->topics()[message.topic].name;
    if (const auto scan_of = owner_of(topic, localizer::kJournalTopic)) {
      journals[*scan_of].add(convert::from_cdr<strata_msgs::msg::LabeledScan>(message.data, topic));
    } else if (const auto point_of = owner_of(topic, localizer::kRestorePointTopic)) {
      journals[*point_of].add(localizer::restore_point(
          convert::from_cdr<rcl_interfaces::msg::ParameterEvent>(message.data, topic)));
    }
  }
  return journals;
}

/// Gives the journals the messages that their maps came with, as far as they were kept.
void read_map_messages(const fs::path& incident, std::map<std::string, JournalReplay>& journals) {
  std::map<std::string, std::vector<JournalReplay*>> wanted;  // by SHA-256
  std::set<std::string> topics;
  for (auto& [name, journal] : journals) {
    for (const localizer::MapMessage& message : journal.wanted()) {
      wanted[message.sha256].push_back(&journal);
      topics.insert(message.topic);
    }
  }
  if (topics.empty()) return;
  const auto bag = log::BagReader::open(incident);
  for (log::BagMessage message; bag->next(message);) {
    const log::BagTopic& topic = bag->topics()[message.topic];
    if (!topics.contains(topic.name)) continue;
    const auto found = localizer::map_message(topic.name, topic.type, message.data);
    if (!found || !wanted.contains(found->sha256)) continue;
    for (JournalReplay* journal : wanted[found->sha256]) journal->add(*found, message.data);
  }
}

bool holds(const fs::path& folder, const std::string& sha256) {
  try {
    return fs::exists(folder) && log::content_digest(folder) == sha256;
  } catch (const InputError&) {
    return false;
  }
}

JournalReplay::FindMaps find_maps_of(const IncidentRecord& record, const fs::path& given) {
  return [&record, given](const RestorePoint& point) -> fs::path {
    if (const auto copy = incident_recorder::kept_copy(record, point.maps_sha256)) return *copy;
    for (const fs::path& folder : {given, fs::path(point.maps)}) {
      if (!folder.empty() && holds(folder, point.maps_sha256)) return folder;
    }
    throw InputError(record.folder.string(),
                     "has no copy of the maps " + point.maps + " (" +
                         point.maps_sha256.substr(0, 12) + "), and they are no longer there",
                     "give a folder with that content by --maps; a recorder keeps a copy with each "
                     "incident (keep_maps) where it runs on the localizer's machine");
  };
}

nlohmann::json as_json(const LocalizerReplay& replay) {
  const JournalReplay::Outcome& outcome = replay.outcome;
  nlohmann::json json{{"scans", outcome.scans},
                      {"replayed", outcome.replayed},
                      {"same", outcome.same},
                      {"restored", outcome.restored},
                      {"without_maps", outcome.without_maps},
                      {"states_compared", outcome.compared},
                      {"states_same", outcome.same_states}};
  if (outcome.first_difference) json["first_difference_s"] = outcome.first_difference->seconds();
  return json;
}

void write(const fs::path& folder, const std::vector<LocalizerReplay>& replays) {
  nlohmann::json summary;
  for (const LocalizerReplay& replay : replays) {
    summary["localizers"][replay.localizer] = as_json(replay);
    const fs::path place = folder / replay.localizer.substr(1);
    std::error_code error;
    fs::create_directories(place, error);
    if (error) throw OutputError(place.string(), "cannot be made: " + error.message(), "");
    log::write_trajectory(place / "trajectory.tum", replay.poses);
  }
  std::ofstream file(folder / "summary.json");
  file << summary.dump(2) << "\n";
  if (!file.flush()) throw OutputError(folder.string(), "cannot be written", "make room");
}

void tell(const LocalizerReplay& replay) {
  const JournalReplay::Outcome& outcome = replay.outcome;
  std::printf("%s: %zu of %zu poses came out to the same bits", replay.localizer.c_str(),
              outcome.same, outcome.replayed);
  if (outcome.compared > 0) {
    std::printf(", and the filter %zu of %zu times", outcome.same_states, outcome.compared);
  }
  if (outcome.scans > outcome.replayed) {
    std::printf("; %s before the first restore point or behind a gap",
                counted(outcome.scans - outcome.replayed, "scan").c_str());
  }
  std::printf("\n");
}

}  // namespace

bool is_incident(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / incident_recorder::kIncidentFile, error);
}

std::vector<LocalizerReplay> replay_incident(const IncidentReplayOptions& options,
                                             VerbContext& context) {
  const auto record = incident_recorder::read_record(options.incident);
  if (!record) {
    throw InputError(options.incident.string(), "is no incident",
                     "name one of those that `strata incidents DIR` lists");
  }
  auto journals = read_journals(options.incident);
  if (journals.empty()) {
    throw InputError(options.incident.string(), "holds no journal of a localizer",
                     "let the recorder keep /LOCALIZER/_journal and /LOCALIZER/_restore_point");
  }
  read_map_messages(options.incident, journals);
  const JournalReplay::FindMaps find_maps = find_maps_of(*record, options.maps);
  std::vector<LocalizerReplay> replays;
  for (const auto& [name, journal] : journals) {
    LocalizerReplay replay{name, {}, {}};
    replay.outcome = journal.run(find_maps, context.options.threads, [&](const auto& scan, auto&) {
      replay.poses.push_back({scan.stamp, scan.replayed.mean});
      report_progress(context.progress(), name, replay.poses.size(), replay.poses.size());
    });
    replays.push_back(std::move(replay));
  }
  return replays;
}

void replay_and_tell(const IncidentReplayOptions& options, const std::string& out,
                     VerbContext& context) {
  std::optional<ResultDirectory> folder;
  if (!out.empty()) folder.emplace(out, "incident_replay", context);
  const std::vector<LocalizerReplay> replays = replay_incident(options, context);
  if (folder) {
    write(folder->path(), replays);
    folder->commit();
  }
  for (const LocalizerReplay& replay : replays) {
    if (!context.options.quiet) tell(replay);
  }
  std::fflush(stdout);
  for (const LocalizerReplay& replay : replays) {
    const JournalReplay::Outcome& outcome = replay.outcome;
    if (outcome.is_same()) continue;
    if (outcome.replayed == 0) {
      throw InputError(replay.localizer, "no scan of the incident can be replayed",
                       "its restore points are of other scans than it kept");
    }
    throw Error(replay.localizer, "something came out otherwise than it was recorded",
                "replay it with the version of Strata that recorded it");
  }
}

}  // namespace strata::tools
