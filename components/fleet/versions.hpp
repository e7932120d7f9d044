// SPDX-License-Identifier: Apache-2.0
/// Versions of a site's maps on the server: released by an operator, fetched by robots.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "components/fleet/connection.hpp"
#include "components/site/site.hpp"

namespace strata::fleet {

struct ServerVersion {
  std::string hash;
  std::string state;  ///< "released" or "withdrawn"
  std::string by;     ///< who set the state
  std::string at;     ///< ... and when, as the server writes UTC
  std::string note;
};

/// PostgreSQL's text of an array of hashes; what is none is left out.
[[nodiscard]] std::string array_of(const std::vector<std::string>& hashes);

/// Those that this role may read, the one that was released last first. O(versions).
[[nodiscard]] std::vector<ServerVersion> versions(Connection& connection, const std::string& site);

/// The one of that hash that this role may read. O(versions).
[[nodiscard]] std::optional<ServerVersion> version_of(Connection& connection,
                                                      const std::string& site,
                                                      const std::string& hash);

/// What robots should use: the one that was released last. Nothing where none is released.
[[nodiscard]] std::optional<ServerVersion> newest_released(Connection& connection,
                                                           const std::string& site);

/// Sends a version of a local site, as a whole or not at all, and releases it; of one that is there
/// only the state changes. Throws InputError where it was not approved there or is damaged, or
/// where site or frame are not those of the server; DeniedError for who is no operator.
void release(Connection& connection, const site::Site& site, const std::string& hash,
             const std::string& note);

/// The same for what is done again and again: only of a version that the server never had. False
/// where it is the one that was released last, which stays as it is. Throws InputError where it was
/// withdrawn or another one was released since: who goes back to it says so by release().
bool release_once(Connection& connection, const site::Site& site, const std::string& hash,
                  const std::string& note);

/// Robots no longer get it. Throws InputError where there is none of that hash.
void withdraw(Connection& connection, const std::string& site, const std::string& hash);

/// Fetches a version into a folder, which is made, and checks the hash over all of it. Throws
/// InputError where it is not to be had, DamageError where its hash does not hold.
void fetch(Connection& connection, const std::string& site, const std::string& hash,
           const std::filesystem::path& folder);

/// Requires that a local site is the server's: same name and frame. Throws InputError.
void require_same_site(Connection& connection, const site::Site& site);

}  // namespace strata::fleet
