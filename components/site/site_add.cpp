// SPDX-License-Identifier: Apache-2.0
// A site is made, and versions are put into it.
#include <algorithm>
#include <system_error>

#include "components/log/content_hash.hpp"
#include "components/log/whole_folder.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/site/site.hpp"
#include "components/site/site_change.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::site {
namespace {

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw OutputError(folder.string(), "cannot be made: " + error.message(),
                      "check the permissions of the folder above it, and free space");
  }
}

/// What SQLite has not yet put into the store would be missing in a copy.
void require_at_rest(const fs::path& maps) {
  std::error_code error;
  const fs::path log = maps / (std::string(maps::kStoreFile) + "-wal");
  const auto bytes = fs::file_size(log, error);
  if (!error && bytes > 0) {
    throw InputError(
        maps.string(),
        "is being written to: " + log.filename().string() + " holds what strata.db does not",
        "end the program that learns there; if none runs, `strata info` on a copy of "
        "the folder shows whether it is whole");
  }
}

}  // namespace

Site Site::create(const fs::path& folder, const std::string& id, const std::string& frame,
                  const Actor& actor, const log::Disk& disk) {
  if (id.empty() || frame.empty()) {
    throw InputError("--id or --frame", "is empty", "name the site, and the frame of its maps");
  }
  log::WholeFolder whole(folder, disk);
  make_folder(whole.aside() / kVersions);
  Decisions decisions;
  decisions.id = id;
  decisions.frame = frame;
  add_event(decisions, "init", "", actor, "");
  write_decisions(whole.aside() / kSiteFile, decisions, disk);
  whole.commit();
  return Site(folder, disk);
}

void Site::copy_maps(const fs::path& maps, const log::HashedContent& content,
                     const fs::path& to) const {
  for (const log::HashedFile& file : content.files) {
    const fs::path copy = to / file.path;
    make_folder(copy.parent_path());
    std::error_code error;
    fs::copy_file(maps / file.path, copy, error);
    if (error) {
      throw OutputError(copy.string(), "cannot be copied: " + error.message(),
                        "free some space, and check that nothing replaces " + maps.string());
    }
  }
  if (log::hash_content(to).hash != content.hash) {
    throw InputError(maps.string(), "changed while it was copied",
                     "try again when nothing writes there");
  }
  (void)maps::open_for_reading(to);  // whole, as far as SQLite can say
}

Site::Added Site::add(const fs::path& maps, const Actor& actor, const std::string& note) {
  const log::HashedContent content = log::hash_content(maps);
  require_at_rest(maps);
  maps::open_for_reading(maps).check_contents();
  Change change(*this);
  Decisions& decisions = change.decisions;
  if (!levels().empty()) {
    throw InputError(folder_.string(), "has levels, and maps are a level's",
                     "add them to " + levels().front().folder.string() + " or another one");
  }
  const fs::path place = folder_ / kVersions / content.hash;
  std::error_code error;
  if (fs::exists(place, error)) return {status_of(content.hash, decisions, active()), false};
  MapVersion version;
  version.hash = content.hash;
  version.number = decisions.next_number;
  for (const VersionStatus& other : versions(decisions)) {
    version.number = std::max(version.number, other.version.number + 1);
  }
  version.parent = active().value_or("");
  version.made = actor;
  version.note = note;
  version.site = decisions.id;
  version.frame = decisions.frame;
  version.facts = facts_of(maps);
  version.files = content.files;
  log::WholeFolder whole(place, *disk_);
  make_folder(whole.aside() / kMaps);
  copy_maps(maps, content, whole.aside() / kMaps);
  write_version(whole.aside() / kVersionFile, version);
  whole.commit();
  decisions.next_number = version.number + 1;
  add_event(decisions, "add", version.hash, actor, note);
  change.commit();
  return {status_of(version.hash, decisions, active()), true};
}

}  // namespace strata::site
