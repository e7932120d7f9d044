// SPDX-License-Identifier: Apache-2.0
/// rosbag2's SQLite storage: schema 3 (Humble) or 4 (Iron), which adds message definitions.
#include <chrono>
#include <set>
#include <string>
#include <utility>

#include "components/log/bag_storage.hpp"
#include "components/log/sqlite_handles.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

/// Somebody may look into a bag that is being recorded, whose lock must not end the recording. To
/// be back in one file at the end is worth less patience.
constexpr int kPatienceMs = 10'000;
constexpr int kPatienceAtEndMs = 500;

class SqliteBagFile : public BagWriter::File {
 public:
  SqliteBagFile(const fs::path& file, int schema) : file_(file), with_definitions_(schema >= 4) {
    sqlite3* database = nullptr;
    const int code = sqlite3_open_v2(file.c_str(), &database,
                                     SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
    database_.reset(database);
    if (code != SQLITE_OK) fail();
    sqlite3_busy_timeout(database_.get(), kPatienceMs);
    if (try_patiently("PRAGMA journal_mode=WAL", kPatienceMs) != SQLITE_OK) fail();
    run("PRAGMA synchronous=NORMAL");
    run("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY,ros_distro TEXT NOT NULL);"
        "CREATE TABLE metadata(id INTEGER PRIMARY KEY,metadata_version INTEGER NOT NULL,"
        "metadata TEXT NOT NULL);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,"
        "timestamp INTEGER NOT NULL,data BLOB NOT NULL);"
        "CREATE INDEX timestamp_idx ON messages (timestamp ASC);");
    run(with_definitions_
            ? "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
              "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL,"
              "type_description_hash TEXT NOT NULL);"
              "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY,topic_type TEXT NOT NULL,"
              "encoding TEXT NOT NULL,encoded_message_definition TEXT NOT NULL,"
              "type_description_hash TEXT NOT NULL);"
              "INSERT INTO schema VALUES (4, 'iron');"
            : "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
              "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL);"
              "INSERT INTO schema VALUES (3, 'humble');");
    add_topic_ = prepare_statement(database_.get(), with_definitions_
                                                        ? "INSERT INTO topics VALUES (?,?,?,?,?,?)"
                                                        : "INSERT INTO topics VALUES (?,?,?,?,?)");
    add_message_ = prepare_statement(
        database_.get(), "INSERT INTO messages (topic_id, timestamp, data) VALUES (?,?,?)");
    if (!add_topic_ || !add_message_) fail();
  }

  void add_topic(const BagTopic& topic) override {
    begin();
    sqlite3_stmt* statement = add_topic_.get();
    sqlite3_reset(statement);
    sqlite3_bind_int64(statement, 1, ++topics_);
    const std::string hash = type_hash_of(topic);
    const std::string* const texts[] = {&topic.name, &topic.type, &topic.serialization_format,
                                        &topic.offered_qos_profiles, &hash};
    for (int i = 0; i < (with_definitions_ ? 5 : 4); ++i) {
      sqlite3_bind_text(statement, i + 2, texts[i]->c_str(), -1, SQLITE_TRANSIENT);
    }
    if (sqlite3_step(statement) != SQLITE_DONE) fail();
    if (with_definitions_ && defined_.insert(topic.type).second) define(topic);
  }

  void write(std::size_t topic, Stamp stamp, std::span<const std::uint8_t> cdr) override {
    begin();
    sqlite3_stmt* statement = add_message_.get();
    sqlite3_reset(statement);
    sqlite3_bind_int64(statement, 1, static_cast<std::int64_t>(topic) + 1);
    sqlite3_bind_int64(statement, 2, stamp.ns);
    sqlite3_bind_blob64(statement, 3, cdr.data(), cdr.size(), SQLITE_STATIC);
    const int code = sqlite3_step(statement);
    sqlite3_reset(statement);
    if (code != SQLITE_DONE) fail();
    ++written_;
    pending_bytes_ += cdr.size();
    if (pending_bytes_ > (1U << 20) || Clock::now() - begun_ > std::chrono::seconds(1)) commit();
  }

  void flush() override { commit(); }
  [[nodiscard]] std::size_t saved() const override { return saved_; }

  void give_up() override {
    sqlite3_reset(add_topic_.get());
    sqlite3_reset(add_message_.get());
    // SQLite may have rolled back by itself, and where it told a failure it may have done its work.
    if (sqlite3_get_autocommit(database_.get()) == 0) {
      sqlite3_exec(database_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
    }
    in_transaction_ = false;
    const Statement last = prepare_statement(database_.get(), "SELECT max(id) FROM messages");
    if (last && sqlite3_step(last.get()) == SQLITE_ROW) {
      saved_ = static_cast<std::size_t>(sqlite3_column_int64(last.get(), 0));
    }
  }

  void close(const std::string& /*metadata*/) override {
    commit();
    // Back to a single file, which any reader on a read-only disk can open. Everything is in the
    // bag already: while somebody reads it stays two files.
    const int code = try_patiently("PRAGMA journal_mode=DELETE", kPatienceAtEndMs);
    if (code != SQLITE_OK && code != SQLITE_BUSY) fail();
    add_topic_.reset();
    add_message_.reset();
    database_.reset();
  }

 private:
  using Clock = std::chrono::steady_clock;
  [[noreturn]] void fail() const {
    throw OutputError(file_.string(), "cannot be written: " + fault_of(database_.get()),
                      "free some space or choose another place");
  }
  void define(const BagTopic& topic) {
    const auto [encoding, text] = definition_of(topic);
    const Statement statement = prepare_statement(
        database_.get(),
        "INSERT INTO message_definitions (topic_type, encoding, encoded_message_definition, "
        "type_description_hash) VALUES (?,?,?,?)");
    if (!statement) fail();
    const std::string hash = type_hash_of(topic);
    const std::string* const values[] = {&topic.type, &encoding, &text, &hash};
    for (int i = 0; i < 4; ++i) {
      sqlite3_bind_text(statement.get(), i + 1, values[i]->c_str(), -1, SQLITE_TRANSIENT);
    }
    if (sqlite3_step(statement.get()) != SQLITE_DONE) fail();
  }
  void run(const char* sql) {
    if (sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
  }
  /// For what SQLite does not wait for by itself; its primary result code.
  int try_patiently(const char* sql, int patience_ms) {
    constexpr int kPauseMs = 5;
    int code = SQLITE_BUSY;
    for (int waited_ms = 0; code == SQLITE_BUSY && waited_ms <= patience_ms;
         waited_ms += kPauseMs) {
      if (waited_ms > 0) sqlite3_sleep(kPauseMs);
      code = sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr) & 0xff;
    }
    return code;
  }
  void begin() {
    if (in_transaction_) return;
    run("BEGIN");
    in_transaction_ = true;
    begun_ = Clock::now();
    pending_bytes_ = 0;
  }
  void commit() {
    if (!in_transaction_) return;
    sqlite3_reset(add_topic_.get());
    run("COMMIT");
    in_transaction_ = false;
    saved_ = written_;
  }

  fs::path file_;
  bool with_definitions_;
  std::set<std::string> defined_;
  Database database_;
  Statement add_topic_;
  Statement add_message_;
  std::int64_t topics_ = 0;
  std::size_t written_ = 0;
  std::size_t saved_ = 0;
  bool in_transaction_ = false;
  std::size_t pending_bytes_ = 0;
  Clock::time_point begun_;
};

}  // namespace

std::unique_ptr<BagWriter::File> create_sqlite_bag(const fs::path& file, int schema) {
  return std::make_unique<SqliteBagFile>(file, schema);
}

}  // namespace strata::log
