// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/connection.hpp"

#include <array>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <utility>

#include <sys/socket.h>
#include <unistd.h>

#include "components/fleet/libpq.hpp"
#include "components/fleet/server_name.hpp"
#include "components/fleet/session_settings.hpp"

namespace strata::fleet {
namespace {

struct Clear {
  void operator()(PGresult* result) const { libpq().clear(result); }
};
struct Finish {
  void operator()(PGconn* connection) const { libpq().finish(connection); }
};
using ResultOwner = std::unique_ptr<PGresult, Clear>;

constexpr Oid kByteaType = 17;  // pg_type.dat: bytea; it never changes
constexpr int kText = 0;
constexpr int kBinary = 1;

std::string one_line(const char* message) {
  std::string text = message != nullptr ? message : "";
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  for (char& c : text) {
    if (c == '\n' || c == '\t') c = ' ';
  }
  return text.empty() ? "the server said nothing" : text;
}

std::string setting_of(PGconn* connection, char* (*ask)(const PGconn*)) {
  const char* value = ask(connection);
  return value != nullptr ? value : "";
}

/// Why nobody is let in, as far as libpq tells it.
[[noreturn]] void fail_to_connect(PGconn* connection, const std::string& place) {
  const std::string why = one_line(libpq().error_message(connection));
  if (libpq().connection_needs_password(connection) != 0) {
    throw DeniedError(place, "asks for a password: " + why,
                      "put it into ~/.pgpass (HOST:PORT:DATABASE:USER:PASSWORD, mode 600) or "
                      "PGPASSWORD");
  }
  // It says FATAL itself; who is killed meanwhile says nothing, and who is stopped says that.
  const bool is_for_now = why.find("terminating connection") != std::string::npos ||
                          why.find("the database system is") != std::string::npos ||
                          why.find("too many") != std::string::npos ||  // connections
                          why.find("connection slots") != std::string::npos;
  if (!is_for_now && libpq().connection_used_password(connection) != 0 &&
      why.find("FATAL") != std::string::npos) {
    throw DeniedError(place, "does not let this user in: " + why,
                      "check user, password and database");
  }
  if (why.find("certificate") != std::string::npos) {
    throw DeniedError(place, "does not show that it is the server that is meant: " + why,
                      "name who signed its certificate (sslrootcert), and the host as it has it");
  }
  throw LostError(place, "cannot be reached: " + why,
                  "check that the server runs, its name and port, and sslmode; what was to be "
                  "sent is still here");
}

}  // namespace

const char* Parameter::data() const {
  static const char nothing = '\0';
  if (!is_bytes_) return text_.c_str();
  return bytes_.empty() ? &nothing : reinterpret_cast<const char*>(bytes_.data());
}

std::string Parameter::text_of(double value) {
  std::array<char, 64> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

struct Rows::Result {
  ResultOwner result;
};

std::size_t Rows::size() const {
  return static_cast<std::size_t>(libpq().ntuples(result_->result.get()));
}
bool Rows::is_null(std::size_t row, int column) const {
  return libpq().getisnull(result_->result.get(), static_cast<int>(row), column) != 0;
}
std::string Rows::text(std::size_t row, int column) const {
  const std::span<const std::byte> raw = bytes(row, column);
  return {reinterpret_cast<const char*>(raw.data()), raw.size()};
}
std::span<const std::byte> Rows::bytes(std::size_t row, int column) const {
  PGresult* result = result_->result.get();
  const int place = static_cast<int>(row);
  return {reinterpret_cast<const std::byte*>(libpq().getvalue(result, place, column)),
          static_cast<std::size_t>(libpq().getlength(result, place, column))};
}
std::int64_t Rows::integer(std::size_t row, int column) const {
  const std::string digits = text(row, column);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) {
    throw ServerError("the server", "answered '" + digits + "' where a number was due",
                      "check that its tables are those of `strata fleet init`", "");
  }
  return value;
}
double Rows::real(std::size_t row, int column) const {
  return std::strtod(text(row, column).c_str(), nullptr);
}

struct Connection::State {
  State() = default;
  ~State() {
    if (socket >= 0) (void)close(socket);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  std::unique_ptr<PGconn, Finish> connection;
  std::string place;
  int statement_s = 0;
  int socket = -1;  // a second handle: libpq may close its own at any time
  std::atomic<std::int64_t> since_ns{0};
};

namespace {

std::int64_t steady_ns() { return std::chrono::steady_clock::now().time_since_epoch().count(); }

/// While a statement is under way.
class Waiting {
 public:
  explicit Waiting(std::atomic<std::int64_t>& since_ns) : since_ns_(since_ns) {
    since_ns_ = steady_ns();
  }
  ~Waiting() { since_ns_ = 0; }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

 private:
  std::atomic<std::int64_t>& since_ns_;
};

}  // namespace

Connection::Connection(const std::string& url, const Patience& patience)
    : state_(std::make_unique<State>()) {
  state_->place = url_without_secrets(url);
  const std::string connect_s = std::to_string(patience.connect_s);
  const std::string silence_ms = std::to_string(1000 * patience.silence_s);
  // The URL is spread out where dbname stands, over what was said before it.
  const std::array<const char*, 8> keys{
      "connect_timeout",  "tcp_user_timeout",          "keepalives_idle", "keepalives_interval",
      "keepalives_count", "fallback_application_name", "dbname",          nullptr};
  const std::array<const char*, 8> values{connect_s.c_str(), silence_ms.c_str(), "10",   "5", "4",
                                          "strata",          url.c_str(),        nullptr};
  state_->connection.reset(libpq().connectdb_params(keys.data(), values.data(), 1));
  PGconn* connection = state_->connection.get();
  if (connection == nullptr) throw std::bad_alloc();
  if (libpq().status(connection) != CONNECTION_OK) fail_to_connect(connection, state_->place);
  state_->place =
      server_name(setting_of(connection, libpq().host), setting_of(connection, libpq().port),
                  setting_of(connection, libpq().db));
  libpq().set_notice_processor(
      connection, [](void*, const char*) {}, nullptr);
  state_->socket = dup(libpq().socket(connection));
  state_->statement_s = patience.statement_s;
  (void)query(kSessionSettings, {std::to_string(patience.statement_s) + "s"});
}

Connection::~Connection() = default;
Connection::Connection(Connection&&) noexcept = default;

const std::string& Connection::place() const { return state_->place; }
std::string Connection::user() const { return setting_of(state_->connection.get(), libpq().user); }
void Connection::cut() const { (void)shutdown(state_->socket, SHUT_RDWR); }
double Connection::waited_s() const {
  const std::int64_t since_ns = state_->since_ns;
  return since_ns == 0 ? 0.0 : static_cast<double>(steady_ns() - since_ns) * 1e-9;
}
bool Connection::is_encrypted() const { return libpq().ssl_in_use(state_->connection.get()) != 0; }

void Connection::fail(const void* raw) {
  const auto* result = static_cast<const PGresult*>(raw);
  const char* code =
      result != nullptr ? libpq().result_error_field(result, PG_DIAG_SQLSTATE) : nullptr;
  const std::string sqlstate = code != nullptr ? code : "";
  const char* primary =
      result != nullptr ? libpq().result_error_field(result, PG_DIAG_MESSAGE_PRIMARY) : nullptr;
  const std::string why =
      one_line(primary != nullptr ? primary : libpq().error_message(state_->connection.get()));
  const std::string& place = state_->place;
  if (libpq().status(state_->connection.get()) != CONNECTION_OK || sqlstate.starts_with("57P") ||
      sqlstate.starts_with("08")) {
    throw LostError(place, "is gone: " + why,
                    "run it again when the server is back: what it has acknowledged is there, and "
                    "the rest is still here");
  }
  if (sqlstate == "42501") {  // insufficient_privilege, also of row-level security
    throw DeniedError(place, "does not allow that to " + user() + ": " + why,
                      "use the URL of a role that may: docs/fleet.md says who may do what");
  }
  if (sqlstate == "42P01" || sqlstate == "3F000" || sqlstate == "42883") {
    throw DeniedError(place, "has no tables of a fleet: " + why,
                      "check the database's name, or make them with `strata fleet init`");
  }
  if (sqlstate.starts_with("53")) {  // insufficient_resources: disk, memory, connections
    throw ServerError(place, "is short of disk, memory or connections: " + why,
                      "free some there and run it again: what it has acknowledged is there, and "
                      "the rest is still here",
                      sqlstate);
  }
  if (sqlstate == "57014" || sqlstate == "55P03") {
    throw ServerError(place,
                      "took longer than " + std::to_string(state_->statement_s) + " s: " + why,
                      "run it again when the server or the network has less to do, or give "
                      "--timeout",
                      sqlstate);
  }
  throw ServerError(place, "refused a statement: " + why + " (" + sqlstate + ")",
                    "the server's log says more", sqlstate);
}

Rows Connection::run(const std::string& sql, std::span<const Parameter> parameters, bool as_bytes) {
  std::vector<Oid> types;
  std::vector<const char*> values;
  std::vector<int> lengths;
  std::vector<int> formats;
  for (const Parameter& parameter : parameters) {
    types.push_back(parameter.is_bytes() ? kByteaType : 0);
    values.push_back(parameter.data());
    lengths.push_back(static_cast<int>(parameter.size()));
    formats.push_back(parameter.is_bytes() ? kBinary : kText);
  }
  const Waiting waiting(state_->since_ns);
  ResultOwner result(libpq().exec_params(
      state_->connection.get(), sql.c_str(), static_cast<int>(parameters.size()), types.data(),
      values.data(), lengths.data(), formats.data(), as_bytes ? kBinary : kText));
  const ExecStatusType status = libpq().result_status(result.get());
  if (status != PGRES_TUPLES_OK && status != PGRES_COMMAND_OK) fail(result.get());
  Rows rows;
  rows.changed_ = std::strtoll(libpq().cmd_tuples(result.get()), nullptr, 10);
  rows.result_ = std::make_shared<Rows::Result>(Rows::Result{std::move(result)});
  return rows;
}

Rows Connection::query(const std::string& sql, std::span<const Parameter> parameters) {
  return run(sql, parameters, false);
}
Rows Connection::query_bytes(const std::string& sql, std::initializer_list<Parameter> parameters) {
  return run(sql, std::span(parameters.begin(), parameters.size()), true);
}

void Connection::script(const std::string& sql) {
  const ResultOwner result(libpq().exec(state_->connection.get(), sql.c_str()));
  const ExecStatusType status = libpq().result_status(result.get());
  if (status != PGRES_TUPLES_OK && status != PGRES_COMMAND_OK) fail(result.get());
}

std::string Connection::verifier_of(const std::string& password, const std::string& role) {
  const std::unique_ptr<char, void (*)(void*)> verifier(
      libpq().encrypt_password_conn(state_->connection.get(), password.c_str(), role.c_str(),
                                    "scram-sha-256"),
      libpq().freemem);
  if (verifier == nullptr) fail(nullptr);
  return verifier.get();
}

void Connection::transaction(const std::function<void()>& body) {
  (void)query("BEGIN");
  try {
    body();
    (void)query("COMMIT");
  } catch (...) {
    try {
      (void)query("ROLLBACK");
    } catch (const Error&) {
      // The connection is gone, and with it the transaction; the first error says why.
    }
    throw;
  }
}

}  // namespace strata::fleet
