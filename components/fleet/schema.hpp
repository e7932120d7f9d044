// SPDX-License-Identifier: Apache-2.0
/// The tables of a fleet's server (schema/001_fleet.sql, packed into the program), and who is in
/// them.
#pragma once

#include <string>
#include <string_view>

#include "components/fleet/connection.hpp"

namespace strata::fleet {

/// Of strata.schema_version. Raise it with a file schema/NNN_*.sql for each change of the tables
/// that programs of before could not go on with: they refuse a newer one.
inline constexpr int kSchemaVersion = 1;

/// The text of schema/001_fleet.sql.
[[nodiscard]] std::string_view schema_text();
/// The text of schema/always.sql: what may be brought up to date in tables that are there.
[[nodiscard]] std::string_view always_text();

/// Makes the tables, or brings those that are there up to date. All or nothing; several may try at
/// once. Returns whether it made any. Throws InputError where a newer program made them,
/// DeniedError where the role may not.
bool apply_schema(Connection& connection);

/// Throws InputError where the tables are missing or of another version.
void require_schema(Connection& connection);

/// Makes a site; false where it is there already. Throws InputError for a name that is none
/// (require_name), or where it is there with another frame.
bool add_site(Connection& connection, const std::string& site, const std::string& frame);

enum class MemberKind { kRobot, kOperator, kOwner };
[[nodiscard]] const char* name_of(MemberKind kind);

struct Member {
  MemberKind kind = MemberKind::kOwner;
  std::string site;  ///< of an owner empty
  std::string name;  ///< ...
  std::string role;  ///< who logs in: "SITE.NAME", of an owner what he is called
};

/// Adds a robot or an operator of a site with a role of its own. The role can log in with that
/// password and no other way. Throws InputError where the name is taken, or the site is missing.
Member add_member(Connection& connection, MemberKind kind, const std::string& site,
                  const std::string& name, const std::string& password);
struct Renewed {
  Member member;
  bool ended_sessions = false;  ///< false: the connection's role may not, and those who are in stay
};
/// Another password for one that is there; the old one is worth nothing from now on, the role's own
/// settings are as at the beginning, and who is logged in is cut off. Where it throws half-way,
/// nobody gets in until it is done again. Throws InputError where there is none.
Renewed renew_password(Connection& connection, MemberKind kind, const std::string& site,
                       const std::string& name, const std::string& password);

/// Who the connection is. Throws InputError where it is neither robot, nor operator, nor the owner
/// of the tables.
[[nodiscard]] Member who_am_i(Connection& connection);

/// Requires that the connection speaks for this site: two sites do not mix. Throws InputError.
Member require_member(Connection& connection, const std::string& site);

/// Lower case letters, digits, - and _, at most 30. what: "site", for the message. Throws
/// InputError.
void require_name(const std::string& name, const std::string& what);

}  // namespace strata::fleet
