// SPDX-License-Identifier: Apache-2.0
/// rosbag2's SQLite storage: schema 4 (Iron), 3 (Humble) and the unnumbered ones before.
#include <algorithm>
#include <chrono>
#include <map>
#include <string>
#include <utility>

#include <sqlite3.h>

#include "components/log/bag_storage.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
};
struct Finalize {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, Finalize>;

Statement prepare(sqlite3* database, const char* sql) {
  sqlite3_stmt* statement = nullptr;
  sqlite3_prepare_v2(database, sql, -1, &statement, nullptr);
  return Statement(statement);
}

std::string column_text(sqlite3_stmt* statement, int column) {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return text == nullptr ? std::string() : std::string(text);
}

class SqliteBagReader : public BagReader {
 public:
  explicit SqliteBagReader(const fs::path& file) : file_(file) {
    sqlite3* database = nullptr;
    // Immutable works in folders that cannot be written, but would not see a live recording's WAL.
    const bool live = fs::exists(fs::path(file.string() + "-wal"));
    std::string uri = "file:";
    for (const char c : fs::absolute(file).string()) {
      uri += c == '?' ? "%3f" : c == '#' ? "%23" : c == '%' ? "%25" : std::string(1, c);
    }
    uri += live ? "?mode=ro" : "?mode=ro&immutable=1";
    const int code =
        sqlite3_open_v2(uri.c_str(), &database, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    database_.reset(database);
    if (code != SQLITE_OK) refuse();
    read_topics();
    read_rows();
    fetch_ = prepare(database_.get(), "SELECT topic_id, data FROM messages WHERE id = ?");
    if (!fetch_) refuse();
  }

  const std::vector<BagTopic>& topics() const override { return topics_; }
  const BagDamage& damage() const override { return damage_; }

  bool next(BagMessage& message) override {
    while (next_ < rows_.size()) {
      const Row row = rows_[next_++];
      sqlite3_reset(fetch_.get());
      sqlite3_bind_int64(fetch_.get(), 1, row.id);
      if (sqlite3_step(fetch_.get()) != SQLITE_ROW) {
        damage_.add(place(row.id) + sqlite3_errmsg(database_.get()));
        continue;
      }
      const auto topic = places_.find(sqlite3_column_int64(fetch_.get(), 0));
      if (topic == places_.end()) {
        damage_.add(place(row.id) + "belongs to no topic");
        continue;
      }
      message.topic = topic->second;
      message.stamp = {row.stamp_ns};
      const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(fetch_.get(), 1));
      const auto size = static_cast<std::size_t>(sqlite3_column_bytes(fetch_.get(), 1));
      message.data.assign(data, data + (data == nullptr ? 0 : size));
      return true;
    }
    return false;
  }

 private:
  struct Row {
    std::int64_t stamp_ns;
    std::int64_t id;
  };

  [[noreturn]] void refuse() const {
    throw InputError(file_.string(),
                     std::string("cannot be read as a bag: ") + sqlite3_errmsg(database_.get()),
                     "check that it was copied whole, or repair it with `sqlite3 .recover`");
  }
  [[nodiscard]] std::string place(std::int64_t id) const {
    return file_.string() + ": message " + std::to_string(id) + ": ";
  }

  void read_topics() {
    const Statement statement =
        prepare(database_.get(),
                "SELECT id, name, type, serialization_format, offered_qos_profiles FROM topics");
    // The oldest bags have no QoS column.
    const Statement old = statement ? nullptr
                                    : prepare(database_.get(),
                                              "SELECT id, name, type, serialization_format, '' "
                                              "FROM topics");
    sqlite3_stmt* rows = statement ? statement.get() : old.get();
    if (rows == nullptr) refuse();
    int code = SQLITE_OK;
    while ((code = sqlite3_step(rows)) == SQLITE_ROW) {
      places_[sqlite3_column_int64(rows, 0)] = topics_.size();
      topics_.push_back(
          {column_text(rows, 1), column_text(rows, 2), column_text(rows, 3), column_text(rows, 4)});
    }
    if (code != SQLITE_DONE) refuse();
  }

  /// Stamps by a scan of the table, not of the index: what a damaged file still has comes out.
  void read_rows() {
    const Statement statement = prepare(database_.get(), "SELECT timestamp, id FROM messages");
    if (!statement) refuse();
    int code = SQLITE_OK;
    while ((code = sqlite3_step(statement.get())) == SQLITE_ROW) {
      rows_.push_back(
          {sqlite3_column_int64(statement.get(), 0), sqlite3_column_int64(statement.get(), 1)});
    }
    if (code != SQLITE_DONE) {
      damage_.add(file_.string() + ": behind message " +
                  std::to_string(rows_.empty() ? 0 : rows_.back().id) + ": " +
                  sqlite3_errmsg(database_.get()));
      if (rows_.empty()) refuse();
    }
    std::sort(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) {
      return std::pair(a.stamp_ns, a.id) < std::pair(b.stamp_ns, b.id);
    });
  }

  fs::path file_;
  Database database_;
  Statement fetch_;
  std::vector<BagTopic> topics_;
  std::map<std::int64_t, std::size_t> places_;
  std::vector<Row> rows_;
  std::size_t next_ = 0;
  BagDamage damage_;
};

class SqliteBagFile : public BagWriter::File {
 public:
  explicit SqliteBagFile(const fs::path& file) : file_(file) {
    sqlite3* database = nullptr;
    const int code = sqlite3_open_v2(file.c_str(), &database,
                                     SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
    database_.reset(database);
    if (code != SQLITE_OK) fail();
    run("PRAGMA journal_mode=WAL");
    run("PRAGMA synchronous=NORMAL");
    run("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY,ros_distro TEXT NOT NULL);"
        "CREATE TABLE metadata(id INTEGER PRIMARY KEY,metadata_version INTEGER NOT NULL,"
        "metadata TEXT NOT NULL);"
        "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
        "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,"
        "timestamp INTEGER NOT NULL,data BLOB NOT NULL);"
        "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
        "INSERT INTO schema VALUES (3, 'humble');");
    add_topic_ = prepare(database_.get(), "INSERT INTO topics VALUES (?,?,?,?,?)");
    add_message_ =
        prepare(database_.get(), "INSERT INTO messages (topic_id, timestamp, data) VALUES (?,?,?)");
    if (!add_topic_ || !add_message_) fail();
  }

  void add_topic(const BagTopic& topic) override {
    begin();
    sqlite3_stmt* statement = add_topic_.get();
    sqlite3_reset(statement);
    sqlite3_bind_int64(statement, 1, ++topics_);
    const std::string* const texts[] = {&topic.name, &topic.type, &topic.serialization_format,
                                        &topic.offered_qos_profiles};
    for (int i = 0; i < 4; ++i) {
      sqlite3_bind_text(statement, i + 2, texts[i]->c_str(), -1, SQLITE_TRANSIENT);
    }
    if (sqlite3_step(statement) != SQLITE_DONE) fail();
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
    pending_bytes_ += cdr.size();
    if (pending_bytes_ > (1U << 20) || Clock::now() - begun_ > std::chrono::seconds(1)) commit();
  }

  void close() override {
    commit();
    // Back to a single file, which any reader on a read-only disk can open.
    run("PRAGMA journal_mode=DELETE");
    add_topic_.reset();
    add_message_.reset();
    database_.reset();
  }

 private:
  using Clock = std::chrono::steady_clock;
  [[noreturn]] void fail() const {
    throw OutputError(file_.string(),
                      std::string("cannot be written: ") + sqlite3_errmsg(database_.get()),
                      "free some space or choose another place");
  }
  void run(const char* sql) {
    if (sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
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
  }

  fs::path file_;
  Database database_;
  Statement add_topic_;
  Statement add_message_;
  std::int64_t topics_ = 0;
  bool in_transaction_ = false;
  std::size_t pending_bytes_ = 0;
  Clock::time_point begun_;
};

}  // namespace

std::unique_ptr<BagReader> open_sqlite_bag(const fs::path& file) {
  return std::make_unique<SqliteBagReader>(file);
}
std::unique_ptr<BagWriter::File> create_sqlite_bag(const fs::path& file) {
  return std::make_unique<SqliteBagFile>(file);
}

}  // namespace strata::log
