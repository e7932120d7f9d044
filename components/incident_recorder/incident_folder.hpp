// SPDX-License-Identifier: Apache-2.0
/// The folder of all incidents: one bag folder each, with incident.json in it, and `files`, where
/// copies of the maps in use lie by their contents.
///
///     incidents/2026-11-25T12-40-03Z_lost/{incident.json, metadata.yaml, ..._0.mcap}
///     incidents/files/SHA256/NAME
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "components/incident_recorder/incident_triggers.hpp"

namespace strata::incident_recorder {

inline constexpr const char* kIncidentFile = "incident.json";

/// A file or folder that an incident keeps a copy of.
struct KeptFile {
  std::string source;  ///< as it was named
  std::string sha256;  ///< of the content; of a folder, of the names and contents in it
};

/// What incident.json says.
struct IncidentRecord {
  std::filesystem::path folder;
  std::vector<IncidentReason> reasons;  ///< the first began it
  std::int64_t at_ns = 0;               ///< when it began, Unix time
  double before_s = 0.0;
  double after_s = 0.0;
  std::uint64_t messages = 0;
  std::uint64_t lost = 0;  ///< that could not be written
  std::vector<KeptFile> files;
  bool is_complete = false;  ///< false: the process ended while it was written
  std::uint64_t bytes = 0;   ///< on disk, without the files
};

/// What incident.json says, as its text.
[[nodiscard]] std::string json_text(const IncidentRecord& record);
/// Replaces the record's file, whole or not at all. Throws OutputError.
void write_record(const IncidentRecord& record);
/// That of one incident; nothing when the folder holds none, or it is damaged.
[[nodiscard]] std::optional<IncidentRecord> read_record(const std::filesystem::path& folder);
/// Where the copy of that content lies, as long as the incident is where it was written; nothing
/// when it kept none. Throws std::filesystem::filesystem_error.
[[nodiscard]] std::optional<std::filesystem::path> kept_copy(const IncidentRecord& record,
                                                             const std::string& sha256);
/// The incidents in a folder, oldest first; others' folders and damaged records are passed over.
[[nodiscard]] std::vector<IncidentRecord> read_records(const std::filesystem::path& incidents);

/// "2026-11-25T12-40-03Z", in UTC, which sorts by time and is a name on every file system.
[[nodiscard]] std::string time_in_name(std::int64_t unix_ns);
/// A name that no incident has yet.
[[nodiscard]] std::filesystem::path free_name(const std::filesystem::path& incidents,
                                              std::int64_t at_ns, const std::string& kind);

/// Copies into incidents/files, where equal contents lie once; in what order is that of `files`. A
/// folder that is replaced meanwhile, as maps are when they are saved, is copied again. What cannot
/// be copied is left out and named in `problems`.
[[nodiscard]] std::vector<KeptFile> keep_files(const std::filesystem::path& incidents,
                                               const std::vector<std::string>& files,
                                               std::vector<std::string>& problems);

/// Removes the oldest incidents, but never the newest, until all of them, with their files, take at
/// most max_bytes, and then the files that no incident names. Returns how many incidents went.
/// Throws OutputError.
std::size_t make_room(const std::filesystem::path& incidents, std::uint64_t max_bytes);

}  // namespace strata::incident_recorder
