// SPDX-License-Identifier: Apache-2.0
/// What the actions of a site share: its own, for no one else.
#pragma once

#include <cstddef>
#include <string>

#include "components/log/folder_lock.hpp"
#include "components/site/site.hpp"

namespace strata::site {

inline constexpr const char* kVersions = "versions";
inline constexpr const char* kMaps = "maps";  ///< of a version
inline constexpr std::size_t kHashDigits = 64;

/// Decisions that nobody else changes meanwhile.
struct Site::Change {
  explicit Change(Site& changed)
      : site(changed), lock(changed.folder_ / "site", changed.wait_), decisions(site.decisions()) {}
  void commit() const { write_decisions(site.folder_ / kSiteFile, decisions, *site.disk_); }

  Site& site;
  log::FolderLock lock;
  Decisions decisions;
};

inline void add_event(Decisions& decisions, const char* what, const std::string& hash,
                      const Actor& actor, const std::string& note) {
  decisions.diary.push_back({what, hash, actor, note});
}

}  // namespace strata::site
