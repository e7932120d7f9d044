// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/schema.hpp"

namespace strata::fleet {
namespace {

/// Any number that nothing else takes: who makes the tables waits for others that do.
constexpr std::int64_t kLock = 0x5374726174610001;

const char* table_of(MemberKind kind) {
  return kind == MemberKind::kRobot ? "strata.robot" : "strata.operator";
}

/// 0: there are no tables.
std::int64_t version_there(Connection& connection) {
  const Rows table = connection.query("SELECT to_regclass('strata.schema_version') IS NOT NULL");
  if (table.text(0, 0) != "t") return 0;
  return connection.query("SELECT max(version) FROM strata.schema_version").integer(0, 0);
}

void refuse_newer(const Connection& connection, std::int64_t version) {
  if (version <= kSchemaVersion) return;
  throw InputError(connection.place(),
                   "has tables of a newer Strata (version " + std::to_string(version) +
                       ", this one knows " + std::to_string(kSchemaVersion) + ")",
                   "update Strata on this machine");
}

void require_site(Connection& connection, const std::string& site) {
  const Rows found = connection.query("SELECT FROM strata.site WHERE site = $1", {site});
  if (found.size() == 1) return;
  std::string there;
  const Rows all = connection.query("SELECT site FROM strata.site ORDER BY site");
  for (std::size_t i = 0; i < all.size(); ++i) there += (i == 0 ? "" : ", ") + all.text(i, 0);
  throw InputError(connection.place(), "has no site '" + site + "'",
                   there.empty() ? "make it with `strata fleet init`" : "there are " + there);
}

/// CREATE ROLE and ALTER ROLE take no parameters: the server itself quotes names and verifier.
void run_formatted(Connection& connection, const std::string& format,
                   std::initializer_list<Parameter> parameters) {
  connection.script(connection.query(format, parameters).text(0, 0));
}

/// Those of a role who are logged in go, and are gone when it returns. False where the connection's
/// role may not do that.
bool end_sessions(Connection& connection, const std::string& role) {
  bool all_ended = false;
  try {
    connection.transaction([&] {
      // Who makes roles may be one of them for a moment.
      run_formatted(connection, "SELECT format('GRANT %I TO %I', $1::text, current_user)", {role});
      all_ended = connection
                      .query(
                          "SELECT coalesce(bool_and(pg_terminate_backend(pid, 5000)), true) "
                          "FROM pg_stat_activity WHERE usename = $1",
                          {role})
                      .text(0, 0) == "t";
      run_formatted(connection, "SELECT format('REVOKE %I FROM %I', $1::text, current_user)",
                    {role});
    });
  } catch (const DeniedError&) {
    return false;
  }
  return all_ended;
}

/// What a role may set of itself: defaults of its sessions, also for one database only.
void reset_settings(Connection& connection, const std::string& role) {
  const Rows rows = connection.query(
      "SELECT format('ALTER ROLE %I IN DATABASE %I RESET ALL', r.rolname, d.datname) FROM "
      "pg_db_role_setting AS s JOIN pg_roles AS r ON r.oid = s.setrole JOIN pg_database AS d ON "
      "d.oid = s.setdatabase WHERE r.rolname = $1",
      {role});
  for (std::size_t i = 0; i < rows.size(); ++i) connection.script(rows.text(i, 0));
  run_formatted(connection, "SELECT format('ALTER ROLE %I RESET ALL', $1::text)", {role});
}

/// A robot needs one or two; who has its password takes none of the others'.
const char* connection_limit(MemberKind kind) {
  return kind == MemberKind::kRobot ? " CONNECTION LIMIT 10" : "";
}

}  // namespace

bool apply_schema(Connection& connection) {
  bool made = false;
  connection.transaction([&] {
    (void)connection.query("SELECT pg_advisory_xact_lock($1::bigint)", {kLock});
    const std::int64_t version = version_there(connection);
    refuse_newer(connection, version);
    made = version == 0;
    if (made) connection.script(std::string(schema_text()));
    connection.script(std::string(always_text()));
  });
  return made;
}

void require_schema(Connection& connection) {
  std::int64_t version = 0;
  try {
    version = version_there(connection);
  } catch (const DeniedError&) {  // of another fleet's role: it may not look into the schema
    throw DeniedError(connection.place(), "knows no robot or operator " + connection.user(),
                      "use the URL that `strata fleet add-robot` printed");
  }
  if (version == 0) {
    throw InputError(connection.place(), "has no tables of a fleet",
                     "check the database's name, or make them with `strata fleet init`");
  }
  refuse_newer(connection, version);
}

bool add_site(Connection& connection, const std::string& site, const std::string& frame) {
  require_name(site, "site");
  const Rows made = connection.query(
      "INSERT INTO strata.site (site, frame) VALUES ($1, $2) ON CONFLICT DO NOTHING",
      {site, frame});
  if (made.changed() == 1) return true;
  const std::string there =
      connection.query("SELECT frame FROM strata.site WHERE site = $1", {site}).text(0, 0);
  if (there != frame) {
    throw InputError(connection.place(), "has site " + site + " in frame '" + there + "'",
                     "give that --frame, or another site's name");
  }
  return false;
}

const char* name_of(MemberKind kind) {
  switch (kind) {
    case MemberKind::kRobot:
      return "robot";
    case MemberKind::kOperator:
      return "operator";
    case MemberKind::kOwner:
      break;
  }
  return "owner";
}

void require_name(const std::string& name, const std::string& what) {
  constexpr std::size_t kMostLetters = 30;  // SITE.ROBOT is a role, of at most 63 bytes
  const bool fits =
      !name.empty() && name.size() <= kMostLetters &&
      name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_") == std::string::npos &&
      name.front() != '-' && name.front() != '_';
  if (fits) return;
  throw InputError("the name of a " + what, "'" + name + "' is none",
                   "use lower case letters, digits, - and _, at most 30, a letter or digit first");
}

Member add_member(Connection& connection, MemberKind kind, const std::string& site,
                  const std::string& name, const std::string& password) {
  require_name(site, "site");
  require_name(name, name_of(kind));
  const Member member{kind, site, name, site + "." + name};
  require_site(connection, site);
  const std::string verifier = connection.verifier_of(password, member.role);
  try {
    connection.transaction([&] {
      run_formatted(connection,
                    std::string("SELECT format('CREATE ROLE %I LOGIN PASSWORD %L") +
                        connection_limit(kind) + " IN ROLE %I', $1::text, $2::text, $3::text)",
                    {member.role, verifier, std::string("strata_") + name_of(kind)});
      (void)connection.query(std::string("INSERT INTO ") + table_of(kind) + " (site, " +
                                 name_of(kind) + ", role_name) VALUES ($1, $2, $3)",
                             {site, name, member.role});
    });
  } catch (const ServerError& error) {
    constexpr std::string_view kDuplicateObject = "42710";
    if (error.sqlstate() != kDuplicateObject) throw;
    throw InputError(connection.place(), "has a role " + member.role + " already",
                     "choose another name, or give --new-password where that is who is meant");
  }
  return member;
}

Renewed renew_password(Connection& connection, MemberKind kind, const std::string& site,
                       const std::string& name, const std::string& password) {
  const Rows found = connection.query(std::string("SELECT role_name FROM ") + table_of(kind) +
                                          " WHERE site = $1 AND " + name_of(kind) + " = $2",
                                      {site, name});
  if (found.size() == 0) {
    throw InputError(connection.place(),
                     "site " + site + " has no " + name_of(kind) + " '" + name + "'",
                     "`strata fleet status` says which there are");
  }
  const Member member{kind, site, name, found.text(0, 0)};
  // A role changes its own password: who is in, or comes in meanwhile, must not be quicker.
  (void)end_sessions(connection, member.role);  // one may hold the role's row
  run_formatted(connection, "SELECT format('ALTER ROLE %I NOLOGIN', $1::text)", {member.role});
  const bool is_alone = end_sessions(connection, member.role);
  const std::string verifier = connection.verifier_of(password, member.role);
  connection.transaction([&] {
    reset_settings(connection, member.role);
    run_formatted(connection,
                  std::string("SELECT format('ALTER ROLE %I LOGIN PASSWORD %L") +
                      connection_limit(kind) + "', $1::text, $2::text)",
                  {member.role, verifier});
  });
  return {member, is_alone};
}

Member who_am_i(Connection& connection) {
  const std::string user = connection.user();
  const Rows owner = connection.query(
      "SELECT pg_has_role(session_user, nspowner, 'USAGE') FROM pg_namespace WHERE nspname = "
      "'strata'");
  if (owner.size() == 1 && owner.text(0, 0) == "t") return {MemberKind::kOwner, "", "", user};
  const Rows me = connection.query("SELECT strata.my_site(), strata.my_robot()");
  if (me.is_null(0, 0)) {
    throw DeniedError(connection.place(), "knows no robot or operator " + user,
                      "use the URL that `strata fleet add-robot` printed");
  }
  const std::string site = me.text(0, 0);
  if (!me.is_null(0, 1)) return {MemberKind::kRobot, site, me.text(0, 1), user};
  return {MemberKind::kOperator, site, user.substr(site.size() + 1), user};
}

Member require_member(Connection& connection, const std::string& site) {
  require_schema(connection);
  const Member member = who_am_i(connection);
  if (member.kind == MemberKind::kOwner) {
    require_site(connection, site);
  } else if (member.site != site) {
    throw InputError(connection.place(),
                     member.role + " is of site " + member.site + ", not of " + site,
                     "two sites do not mix: give that site's own URL and folder");
  }
  return member;
}

}  // namespace strata::fleet
