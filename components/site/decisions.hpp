// SPDX-License-Identifier: Apache-2.0
/// What was decided of a site's versions: site.json, replaced whole at each decision.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "components/log/disk.hpp"
#include "components/site/map_version.hpp"

namespace strata::site {

enum class VersionState {
  kCandidate,  ///< came, and nobody has decided
  kApproved,   ///< may be activated
  kActive,     ///< what robots localize in
  kRetired,    ///< was active
};
[[nodiscard]] const char* name_of(VersionState state);

/// Of one version. Which one is active is not here: the link `active` alone says it.
struct Decision {
  std::optional<Actor> approved;
  std::string approval_note;  ///< how it was checked, or why it was not
  bool was_active = false;
};

/// One line of the site's diary.
struct Event {
  std::string what;  ///< "init", "add", "approve", "activate", "rollback", "gc", "zones", "plan",
                     ///< "level", "interrupted"
  std::string hash;
  Actor actor;
  std::string note;
};

struct Decisions {
  std::string id;     ///< VDA 5050's mapId
  std::string frame;  ///< that all versions' coordinates are in
  int next_number = 1;
  std::map<std::string, Decision> versions;  ///< by hash
  /// Hashes in the order in which they became active; the last is active, the one before it is what
  /// `rollback` gives back.
  std::vector<std::string> activations;
  std::vector<Event> diary;  ///< the last kMaxDiary

  /// As the link says, where a kill fell between this file and it. O(activations).
  void agree_with(const std::optional<std::string>& active);
};

inline constexpr std::size_t kMaxDiary = 1000;

[[nodiscard]] nlohmann::json to_json(const Event& event);
/// Throws InputError where the file is missing or damaged.
[[nodiscard]] Decisions read_decisions(const std::filesystem::path& file);
/// Whole or not at all. Throws OutputError.
void write_decisions(const std::filesystem::path& file, const Decisions& decisions,
                     const log::Disk& disk);

}  // namespace strata::site
