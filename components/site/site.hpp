// SPDX-License-Identifier: Apache-2.0
/// A site: the immutable versions of one building's maps, and which of them robots localize in.
///
///     SITE/site.json             what was decided: Decisions
///     SITE/versions/HASH/maps/   a MAPS folder, never changed
///     SITE/versions/HASH/version.json
///     SITE/active                a link to versions/HASH/maps
///     SITE/recordings/N_NAME/    log/NAME, truth/NAME: what the gate replays
///     SITE/zones.geojson         what people drew over the maps: Zones
///     SITE/plan/                 what an architect drew, and where it lies: FloorPlan
///     SITE/levels/NAME/          of a building: a site of each level, with level.json
///
/// Every step is one rename, synced: a kill or a power cut leaves what was before or what is to be.
/// Several programs may work on a site; those that change it wait for each other. One thread at a
/// time for each object.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/log/disk.hpp"
#include "components/site/decisions.hpp"
#include "components/site/floor_plan.hpp"
#include "components/site/level.hpp"
#include "components/site/map_version.hpp"
#include "components/site/zones.hpp"

namespace strata::site {

inline constexpr const char* kSiteFile = "site.json";
inline constexpr const char* kActiveLink = "active";

/// A version as it stands now.
struct VersionStatus {
  MapVersion version;  ///< only its hash, where `fault` says that the rest cannot be read
  VersionState state = VersionState::kCandidate;
  Decision decision;
  std::string fault;  ///< of version.json; the maps are looked at by Site::fault_of
};

/// What `rollback` and `activate` did.
struct Switch {
  std::string from;  ///< hash; empty: nothing was active
  std::string to;
};

/// A recording that the gate replays.
struct KeptRecording {
  int number = 0;  ///< in the order of coming, from 1 on
  std::filesystem::path folder;
  std::filesystem::path log;
  std::filesystem::path truth;  ///< empty: nobody knows the true poses
  std::uint64_t bytes = 0;
};

class Site {
 public:
  /// Called again and again while another program changes the site, with who that is; false gives
  /// up, and the call throws Cancelled.
  using Wait = std::function<bool(const std::string& holder)>;

  /// Makes a site in a folder that is empty or does not exist. Throws OutputError.
  static Site create(const std::filesystem::path& folder, const std::string& id,
                     const std::string& frame, const Actor& actor,
                     const log::Disk& disk = log::real_disk());
  /// Throws InputError where there is none.
  explicit Site(const std::filesystem::path& folder, const log::Disk& disk = log::real_disk());
  void wait_with(Wait wait) { wait_ = std::move(wait); }

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] Decisions decisions() const;
  /// By number; damaged ones last.
  [[nodiscard]] std::vector<VersionStatus> versions() const;
  /// Whether a version of that hash is here, whose version.json can be read.
  [[nodiscard]] bool has(const std::string& hash) const;
  /// Hash of the active version.
  [[nodiscard]] std::optional<std::string> active() const;
  [[nodiscard]] std::filesystem::path maps_of(const std::string& hash) const;

  /// The version that a user means by a number, the begin of a hash (4 digits or more), "active",
  /// "previous" (what rollback would give back) or "newest". Throws InputError that says which
  /// there are.
  [[nodiscard]] VersionStatus find(const std::string& name) const;
  /// What is wrong with a version's files: their hash does not hold; "" for nothing. O(bytes).
  [[nodiscard]] std::string fault_of(const std::string& hash) const;

  struct Added {
    VersionStatus status;
    bool is_new = false;  ///< false: it was there already
  };
  /// Copies a MAPS folder in as a candidate. Throws InputError where that is no whole MAPS folder,
  /// or changes meanwhile, and OutputError.
  Added add(const std::filesystem::path& maps, const Actor& actor, const std::string& note);
  /// What a judgement was made against: the hash that was active then, "" for none.
  using From = std::optional<std::string>;
  /// note: how it was checked. Throws InputError for a damaged version, and where another version
  /// than `from` is active.
  void approve(const std::string& hash, const Actor& actor, const std::string& note,
               const From& from = std::nullopt);
  /// Throws InputError where the version is damaged, was never approved, or is to take the place of
  /// `from` and another one is active: then nothing changes.
  Switch activate(const std::string& hash, const Actor& actor, const From& from = std::nullopt);
  /// Activates what was active before; from there, once more, what was before that. Throws
  /// InputError where there is none, it is damaged, or, unless `from` is empty, where another
  /// version than that hash is active.
  Switch rollback(const Actor& actor, const std::string& from = "");

  /// The recordings that the gate replays, the oldest first.
  [[nodiscard]] std::vector<KeptRecording> recordings() const;
  /// Copies a recording in, with its true poses where `truth` is not empty; the oldest ones go
  /// until all take at most max_bytes. Returns those that went. Throws InputError where this one
  /// alone is larger, and OutputError.
  std::vector<KeptRecording> keep(const std::filesystem::path& log,
                                  const std::filesystem::path& truth, std::uint64_t max_bytes,
                                  const Actor& actor);

  [[nodiscard]] std::filesystem::path zones_file() const { return folder_ / kZonesFile; }
  /// None where there is no such file. Throws InputError for a damaged one.
  [[nodiscard]] Zones zones() const;
  /// Has the zones changed by `change` while nobody else changes the site, and writes them whole.
  /// With `replaces` it is given none, whatever is there, be it damaged. what: for the diary. What
  /// `change` throws leaves the file as it is; throws InputError and OutputError.
  Zones change_zones(const std::function<void(Zones&)>& change, const Actor& actor,
                     const std::string& what, bool replaces = false);

  [[nodiscard]] bool has_plan() const;
  /// Nothing where there is none. Throws InputError for a damaged one.
  [[nodiscard]] std::optional<FloorPlan> plan() const;
  /// Takes a plan with where it lies. Throws InputError where there is one already, and
  /// OutputError.
  void set_plan(FloorPlan plan, const Actor& actor);
  /// Takes it away, be it damaged. Throws InputError where there is none, and OutputError.
  void remove_plan(const Actor& actor);

  /// From the lowest up; none of a site that is no building. Throws InputError for a damaged one.
  [[nodiscard]] std::vector<Level> levels() const;
  /// Makes a level, a site of its own in this one's frame. id: its mapId. Throws InputError where
  /// the name is taken or cannot be a folder's, where this site has maps or is a level itself, and
  /// OutputError.
  Level add_level(const std::string& name, double elevation_m, const std::string& id,
                  const Actor& actor);
  /// Throws InputError where there is none, or it has versions.
  void remove_level(const std::string& name, const Actor& actor);

  struct Rubbish {
    std::size_t keep_retired = 5;  ///< so many of those that were active last stay
    bool damaged = false;          ///< those that are damaged go, too
    bool dry_run = false;          ///< only say what would go
    bool replaced_only = false;    ///< no candidate goes, nor one that was rolled back from
  };
  /// Removes what is older than the active version: candidates, and versions that were active, but
  /// for the last and the first, whose frame is the site's; never one that was approved and waits.
  /// Returns what went (or would).
  std::vector<VersionStatus> remove_rubbish(const Rubbish& rubbish, const Actor& actor);

 private:
  struct Change;  // the lock, and the decisions under it
  [[nodiscard]] VersionStatus status_of(const std::string& hash, const Decisions& decisions,
                                        const std::optional<std::string>& active) const;
  [[nodiscard]] std::vector<VersionStatus> versions(const Decisions& decisions) const;
  void require_good(const std::string& hash) const;
  void require_active(const From& from) const;
  void point_to(const std::string& hash);
  void remove_left_overs() const;
  void copy_maps(const std::filesystem::path& maps, const log::HashedContent& content,
                 const std::filesystem::path& to) const;

  const log::Disk* disk_;
  std::filesystem::path folder_;
  Wait wait_;
};

}  // namespace strata::site
