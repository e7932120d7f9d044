// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/pull.hpp"

#include <filesystem>
#include <utility>

#include "components/fleet/scratch.hpp"

namespace fs = std::filesystem;

namespace strata::fleet {

std::optional<Pulled> pull(Connection& connection, site::Site& site, const PullOptions& options,
                           const site::Actor& actor) {
  require_same_site(connection, site);
  const std::string id = site.decisions().id;
  const std::optional<ServerVersion> wanted = newest_released(connection, id);
  if (!wanted) return std::nullopt;
  const std::string note = "released by " + wanted->by + " at " + wanted->at + " on " +
                           connection.place() + (wanted->note.empty() ? "" : ": " + wanted->note);
  Pulled pulled;
  pulled.version = *wanted;
  pulled.is_new = !site.has(wanted->hash);
  if (pulled.is_new) {
    const Scratch scratch(site.folder() / "fetched");
    fetch(connection, id, wanted->hash, scratch.folder());
    (void)site.add(scratch.folder(), actor, note);
  }
  pulled.status = site.find(wanted->hash);
  if (options.approve && pulled.status.state == site::VersionState::kCandidate) {
    site.approve(wanted->hash, actor, note);
  }
  if (options.activate) (void)site.activate(wanted->hash, actor);
  pulled.status = site.find(wanted->hash);
  return pulled;
}

std::vector<site::VersionStatus> collect(site::Site& site, std::size_t keep_retired,
                                         const site::Actor& actor) {
  return site.remove_rubbish({.keep_retired = keep_retired, .replaced_only = true}, actor);
}

}  // namespace strata::fleet
