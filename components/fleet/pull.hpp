// SPDX-License-Identifier: Apache-2.0
/// A released version on its way into a robot's own site.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "components/fleet/versions.hpp"

namespace strata::fleet {

/// What becomes of a version that was pulled.
struct PullOptions {
  bool approve = false;   ///< it may be activated: its release counts as the approval
  bool activate = false;  ///< robots of the folder localize in it from now on; needs `approve`
};

struct Pulled {
  ServerVersion version;
  site::VersionStatus status;
  bool is_new = false;  ///< false: the site had it
};

/// Brings the version that was released last into a local site, which does with it what it does
/// with any other; fetches nothing that the site has. Nothing where none is released. Throws
/// InputError where the site is another one, and as fetch(), site::Site and Connection do: then
/// the site is as it was.
[[nodiscard]] std::optional<Pulled> pull(Connection& connection, site::Site& site,
                                         const PullOptions& options, const site::Actor& actor);

/// Removes what was active in a local site before, but for the last `keep_retired` and the first;
/// candidates, versions that were approved and wait, and those that somebody went back from stay.
/// Returns what went. Throws OutputError.
std::vector<site::VersionStatus> collect(site::Site& site, std::size_t keep_retired,
                                         const site::Actor& actor);

}  // namespace strata::fleet
