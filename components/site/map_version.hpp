// SPDX-License-Identifier: Apache-2.0
/// One version of a site's maps: what never changes of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "components/log/content_hash.hpp"

namespace strata::site {

inline constexpr const char* kVersionFile = "version.json";

/// Who did something, and when.
struct Actor {
  std::string by;
  std::int64_t at_ns = 0;  ///< Unix time
};

/// What version.json says, beside the folder `maps` that it speaks of.
struct MapVersion {
  std::string hash;      ///< of the maps' content (components/log/content_hash.hpp); its name
  int number = 0;        ///< from 1 on, in the order of coming; for people
  std::string parent;    ///< hash of the version that was active when it came; may be empty
  Actor made;            ///< who added it
  std::string note;      ///< in the words of who added it
  std::string site;      ///< id of the site: VDA 5050's mapId
  std::string frame;     ///< that its coordinates are in
  nlohmann::json facts;  ///< of summary.json: logs, runs, scans, path and duration, consistency
  std::vector<log::HashedFile> files;

  [[nodiscard]] std::uint64_t bytes() const;
};

[[nodiscard]] nlohmann::json to_json(const MapVersion& version);
/// With a checksum over all of it. Throws OutputError.
void write_version(const std::filesystem::path& file, const MapVersion& version);
/// Throws InputError where it is missing, cut, or its checksum does not hold.
[[nodiscard]] MapVersion read_version(const std::filesystem::path& file);

/// "2026-11-25T12:40:03Z", in UTC.
[[nodiscard]] std::string utc_text(std::int64_t unix_ns);

/// Of summary.json of a MAPS folder, what a version keeps; an empty object where there is none.
[[nodiscard]] nlohmann::json facts_of(const std::filesystem::path& maps);

}  // namespace strata::site
