// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::FleetMember.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "core/base/config.hpp"

namespace strata::fleet_member {

/// What becomes of a version that was pulled.
enum class Pulled {
  kCandidate,  ///< somebody looks at it
  kApproved,   ///< its release counts as the approval
  kActive,     ///< robots of the site folder localize in it
};

}  // namespace strata::fleet_member

template <>
struct strata::EnumNames<strata::fleet_member::Pulled> {
  static constexpr std::array<std::pair<strata::fleet_member::Pulled, const char*>, 3> values{
      {{strata::fleet_member::Pulled::kCandidate, "candidate"},
       {strata::fleet_member::Pulled::kApproved, "approve"},
       {strata::fleet_member::Pulled::kActive, "activate"}}};
};

namespace strata::fleet_member {

struct RetryConfig {
  double first_s = 5.0;
  double longest_s = 30.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("first_s", c.first_s,
            {.doc = "how long it waits after the first failure; after each further one twice as "
                    "long",
             .unit = "s",
             .min = 0.01,
             .max = 86400.0});
    v.field("longest_s", c.longest_s,
            {.doc = "... but never longer", .unit = "s", .min = 0.01, .max = 86400.0});
    v.require(c.first_s <= c.longest_s, "longest_s", "is shorter than first_s", "raise it");
  }
};

/// Parameters are told to whoever asks over DDS.
[[nodiscard]] inline bool has_password(const std::string& url) {
  if (url.find("password=") != std::string::npos) return true;
  const auto begin = url.find("://");
  if (begin == std::string::npos) return false;
  const std::string rest = url.substr(begin + 3);
  const std::string authority = rest.substr(0, rest.find_first_of("/?"));
  const auto at = authority.rfind('@');
  return at != std::string::npos && authority.substr(0, at).find(':') != std::string::npos;
}

struct FleetMemberConfig {
  std::string server;
  std::string site;
  std::vector<std::string> maps;
  std::string site_folder;
  Pulled pulled = Pulled::kCandidate;
  double period_s = 20.0;
  double timeout_s = 120.0;
  double spacing_m = 0.0;
  double tolerance_cells = 0.0;
  int keep_retired = 5;
  RetryConfig retry;
  RetryConfig unusable{.first_s = 60.0, .longest_s = 3600.0};
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("server", c.server,
            {.doc = "URL as libpq has it, of the robot's role, without a password (~/.pgpass or "
                    "PGPASSWORD have it): "
                    "postgresql://hall-3.robot-1@server/fleet?sslmode=verify-full",
             .when = "always"});
    v.require(!c.server.empty(), "server", "is missing", "give the URL that `add-robot` printed");
    v.require(!has_password(c.server), "server",
              "has a password in it, and parameters are no secret",
              "write it into ~/.pgpass or PGPASSWORD");
    v.field("site", c.site, {.doc = "the site's name on the server", .when = "always"});
    v.require(!c.site.empty(), "site", "is missing", "name it as `strata fleet init` did");
    v.field("maps", c.maps,
            {.doc = "MAPS folders whose visits are pushed; one that is not there has none yet",
             .when = "the robot's visits are to be shared"});
    v.field("spacing_m", c.spacing_m,
            {.doc = "of a visit a scan is sent every so far, or half a radian, or 10 s; 0: every "
                    "scan, seven times as much as with 0.5",
             .unit = "m",
             .min = 0.0,
             .max = 10.0});
    v.field(
        "tolerance_cells", c.tolerance_cells,
        {.doc = "visits are told relative to site_folder's active version, where the server has "
                "released it: beams that end so near to where its map says end there; 0: visits "
                "are sent as they were measured",
         .unit = "cells",
         .min = 0.0,
         .max = 3.0});
    v.field("site_folder", c.site_folder,
            {.doc = "local site into which released versions are pulled; empty: none is",
             .when = "the robot is to get released maps"});
    v.require(!c.maps.empty() || !c.site_folder.empty(), "maps",
              "and site_folder are empty: there is nothing to do", "give one of them");
    v.field("pulled", c.pulled,
            {.doc = "what becomes of a version that was pulled: candidate; approve: its release "
                    "counts as the approval; activate: robots of the folder localize in it",
             .when = "robots are to take released maps without being asked"});
    v.field("period_s", c.period_s,
            {.doc = "from one look at folders and server to the next",
             .unit = "s",
             .min = 0.01,
             .max = 86400.0});
    v.field("timeout_s", c.timeout_s,
            {.doc = "so long one statement may take at the server",
             .unit = "s",
             .min = 1.0,
             .max = 86400.0});
    v.field("keep_retired", c.keep_retired,
            {.doc = "after an activation so many of the versions that were active before stay in "
                    "site_folder, and the first one",
             .min = 0,
             .max = 1'000'000});
    v.group("retry", c.retry, "when the server is down, gone, full or slow");
    v.group("unusable", c.unusable,
            "when a release came that cannot be used here: of a newer Strata, damaged, no room");
  }
};

}  // namespace strata::fleet_member
