// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/versions.hpp"

#include <array>
#include <fstream>
#include <set>
#include <system_error>

#include "components/fleet/schema.hpp"
#include "components/fleet/visits.hpp"
#include "components/log/content_hash.hpp"
#include "core/base/damage.hpp"

namespace fs = std::filesystem;

namespace strata::fleet {
namespace {

/// Files go in parts, so that none is too large for a row and a slow network ends each in time.
constexpr std::size_t kPartBytes = 4U << 20U;

void send_file(Connection& connection, const std::string& site, const std::string& hash,
               const fs::path& folder, const std::string& path) {
  std::ifstream in(folder / path, std::ios::binary);
  std::vector<char> bytes(kPartBytes);
  for (int part = 0;; ++part) {
    in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    const auto size = static_cast<std::size_t>(in.gcount());
    if (in.bad() || (part == 0 && size == 0 && !in.eof())) {
      throw InputError((folder / path).string(), "cannot be read", "check the disk");
    }
    if (size == 0 && part > 0) return;
    (void)connection.query(
        "INSERT INTO strata.version_file (site, hash, path, part, payload) VALUES ($1, $2, $3, "
        "$4, $5)",
        {site, hash, path, part, std::as_bytes(std::span(bytes).first(size))});
    if (size < bytes.size()) return;
  }
}

/// Who can write there must not make us write elsewhere.
void require_path_inside(const std::string& path, const std::string& place) {
  const fs::path normal = fs::path(path).lexically_normal();
  if (!path.empty() && normal.is_relative() && normal.string() == path && *normal.begin() != "..") {
    return;
  }
  throw DamageError(place, "names a file '" + path + "', which is none of a folder of maps",
                    "withdraw this version, and look who released it");
}

void fetch_file(Connection& connection, const std::string& site, const std::string& hash,
                const std::string& path, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  std::ofstream out(to, std::ios::binary);
  for (int part = 0; out; ++part) {  // a full disk takes none of the rest
    const Rows rows = connection.query_bytes(
        "SELECT payload FROM strata.version_file WHERE site = $1 AND hash = $2 AND path = $3 AND "
        "part = $4",
        {site, hash, path, part});
    if (rows.size() == 0) break;
    const std::span<const std::byte> bytes = rows.bytes(0, 0);
    out.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
  }
  out.close();
  if (!out) throw OutputError(to.string(), "cannot be written", "free some space");
}

Rows versions_there(Connection& connection, const std::string& site) {
  return connection.query(
      "SELECT hash, state, state_by, to_char(state_at AT TIME ZONE 'UTC', "
      "'YYYY-MM-DD\"T\"HH24:MI:SS\"Z\"'), note FROM strata.version WHERE site = $1 AND state <> "
      "'loading' ORDER BY state_at DESC, hash",
      {site});
}

}  // namespace

std::string array_of(const std::vector<std::string>& hashes) {
  std::string text = "{";
  for (const std::string& hash : hashes) {
    if (hash.find_first_not_of("0123456789abcdef") != std::string::npos) continue;
    text += (text.size() == 1 ? "" : ",") + hash;
  }
  return text + "}";
}

std::vector<ServerVersion> versions(Connection& connection, const std::string& site) {
  const Rows rows = versions_there(connection, site);
  std::vector<ServerVersion> all;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    all.push_back(
        {rows.text(i, 0), rows.text(i, 1), rows.text(i, 2), rows.text(i, 3), rows.text(i, 4)});
  }
  return all;
}

std::optional<ServerVersion> version_of(Connection& connection, const std::string& site,
                                        const std::string& hash) {
  for (ServerVersion& one : versions(connection, site)) {
    if (one.hash == hash) return std::move(one);
  }
  return std::nullopt;
}

std::optional<ServerVersion> newest_released(Connection& connection, const std::string& site) {
  for (ServerVersion& version : versions(connection, site)) {
    if (version.state == "released") return std::move(version);
  }
  return std::nullopt;
}

void require_same_site(Connection& connection, const site::Site& site) {
  const site::Decisions local = site.decisions();
  (void)require_member(connection, local.id);
  const std::string frame =
      connection.query("SELECT frame FROM strata.site WHERE site = $1", {local.id}).text(0, 0);
  if (frame == local.frame) return;
  throw InputError(
      site.folder().string(),
      "is in frame '" + local.frame + "', and site " + local.id + " on the server in '" + frame +
          "'",
      "make the folder with `strata site init --id " + local.id + " --frame " + frame + "`");
}

void release(Connection& connection, const site::Site& site, const std::string& hash,
             const std::string& note) {
  require_same_site(connection, site);
  const site::VersionStatus status = site.find(hash);
  const std::string& name = status.version.hash;
  if (status.state == site::VersionState::kCandidate) {
    throw InputError(site.maps_of(name).string(), "was not approved",
                     "`strata site approve` asks the gate, and approves it");
  }
  const std::string fault = site.fault_of(name);
  if (!fault.empty()) {
    throw InputError(site.maps_of(name).string(), "is damaged: " + fault, "take another version");
  }
  const std::string id = site.decisions().id;
  connection.transaction([&] {
    const Rows there = connection.query(
        "UPDATE strata.version SET state = 'released' WHERE site = $1 AND hash = $2", {id, name});
    if (there.changed() == 1) return;
    (void)connection.query(
        "INSERT INTO strata.version (site, hash, runs, facts, note) VALUES ($1, $2, $3, $4, $5)",
        {id, name, array_of(run_hashes(site.maps_of(name))), to_json(status.version).dump(), note});
    for (const log::HashedFile& file : status.version.files) {
      send_file(connection, id, name, site.maps_of(name), file.path);
    }
    (void)connection.query(
        "UPDATE strata.version SET state = 'released' WHERE site = $1 AND hash = $2", {id, name});
  });
}

bool release_once(Connection& connection, const site::Site& site, const std::string& hash,
                  const std::string& note) {
  require_same_site(connection, site);
  const std::string id = site.decisions().id;
  const std::string name = site.find(hash).version.hash;
  const std::optional<ServerVersion> there = version_of(connection, id, name);
  if (!there) {
    release(connection, site, name, note);
    return true;
  }
  const std::optional<ServerVersion> newest = newest_released(connection, id);
  if (newest && newest->hash == name) return false;
  throw InputError(
      connection.place(),
      "has had version " + log::short_hash(name) + " before: " +
          (there->state == "withdrawn" ? "it was withdrawn" : "another one was released") + " at " +
          (there->state == "withdrawn" ? *there : *newest).at + " by " +
          (there->state == "withdrawn" ? *there : *newest).by,
      "with --again robots go back to it; else activate here what they are to use");
}

void withdraw(Connection& connection, const std::string& site, const std::string& hash) {
  (void)require_member(connection, site);
  const Rows changed = connection.query(
      "UPDATE strata.version SET state = 'withdrawn' WHERE site = $1 AND hash = $2 AND state = "
      "'released'",
      {site, hash});
  if (changed.changed() == 1) return;
  throw InputError(connection.place(), "has released no version " + log::short_hash(hash),
                   "`strata fleet status` says which there are");
}

void fetch(Connection& connection, const std::string& site, const std::string& hash,
           const fs::path& folder) {
  const Rows rows = connection.query(
      "SELECT DISTINCT path FROM strata.version_file WHERE site = $1 AND hash = $2", {site, hash});
  if (rows.size() == 0) {
    throw InputError(connection.place(), "has released no version " + log::short_hash(hash),
                     "`strata fleet status` says which there are");
  }
  const std::string place = connection.place() + ": version " + log::short_hash(hash);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string path = rows.text(i, 0);
    require_path_inside(path, place);
    fetch_file(connection, site, hash, path, folder / path);
  }
  if (log::hash_content(folder).hash != hash) {
    throw DamageError(place, "is damaged: its hash does not hold",
                      "run it again; when that helps nothing, an operator withdraws this version");
  }
}

}  // namespace strata::fleet
