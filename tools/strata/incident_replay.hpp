// SPDX-License-Identifier: Apache-2.0
/// An incident's localizers gone through again, from the journals that they kept.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "components/localizer/journal_replay.hpp"
#include "components/log/trajectory_file.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

struct IncidentReplayOptions {
  std::filesystem::path incident;
  /// Where the maps lie when the incident has no copy of them; empty: where they lay.
  std::filesystem::path maps;
};

/// What came out of one localizer's journal.
struct LocalizerReplay {
  std::string localizer;  ///< "/localizer"
  localizer::JournalReplay::Outcome outcome;
  std::vector<log::StampedPose> poses;  ///< map_from_robot, as they came out again
};

/// Whether the folder is an incident, and not one of many.
[[nodiscard]] bool is_incident(const std::filesystem::path& folder);

/// All that have a journal, by name. The maps are those of the same content as when it was
/// recorded: the incident's copy, --maps or the folder itself. Throws InputError when the folder is
/// no incident, no localizer kept a journal, or the maps are not to be found.
[[nodiscard]] std::vector<LocalizerReplay> replay_incident(const IncidentReplayOptions& options,
                                                           VerbContext& context);

/// Replays, writes OUT (none when empty) and says in a line a localizer what came out. Throws Error
/// when something came out otherwise than it was recorded.
void replay_and_tell(const IncidentReplayOptions& options, const std::string& out,
                     VerbContext& context);

}  // namespace strata::tools
