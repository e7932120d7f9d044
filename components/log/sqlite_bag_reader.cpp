// SPDX-License-Identifier: Apache-2.0
/// rosbag2's SQLite storage: schema 4 (Iron), 3 (Humble) and the unnumbered ones before.
#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "components/log/bag_storage.hpp"
#include "components/log/sqlite_handles.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

std::string column_text(sqlite3_stmt* statement, int column) {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return text == nullptr ? std::string() : std::string(text);
}

class SqliteBagReader : public BagReader {
 public:
  SqliteBagReader(const fs::path& file, fs::path shown) : file_(std::move(shown)) {
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
    read_schema();
    read_topics();
    read_rows();
    fetch_ = prepare_statement(database_.get(), "SELECT topic_id, data FROM messages WHERE id = ?");
    if (!fetch_) refuse();
  }

  const std::vector<BagTopic>& topics() const override { return topics_; }
  const BagDamage& damage() const override { return damage_; }
  std::string description() const override { return description_; }

  bool next(BagMessage& message) override {
    while (next_ < rows_.size()) {
      const Row row = rows_[next_++];
      sqlite3_reset(fetch_.get());
      sqlite3_bind_int64(fetch_.get(), 1, row.id);
      if (sqlite3_step(fetch_.get()) != SQLITE_ROW) {
        damage_.add(place(row.id) + fault_of(database_.get()));
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
    throw InputError(file_.string(), "cannot be read as a bag: " + fault_of(database_.get()),
                     "check that it was copied whole, or repair it with `sqlite3 .recover`");
  }
  [[nodiscard]] std::string place(std::int64_t id) const {
    return file_.string() + ": message " + std::to_string(id) + ": ";
  }

  void read_schema() {
    const Statement statement = prepare_statement(
        database_.get(), "SELECT schema_version, ros_distro FROM schema ORDER BY schema_version");
    if (!statement) return;  // before Humble
    if (sqlite3_step(statement.get()) != SQLITE_ROW) return;
    description_ = "SQLite schema " + std::to_string(sqlite3_column_int(statement.get(), 0)) +
                   " (" + column_text(statement.get(), 1) + ")";
  }

  void read_topics() {
    const Statement statement = prepare_statement(
        database_.get(),
        "SELECT id, name, type, serialization_format, offered_qos_profiles FROM topics");
    // The oldest bags have no QoS column.
    const Statement old = statement
                              ? nullptr
                              : prepare_statement(database_.get(),
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
    read_definitions();
  }

  /// From schema 4 on.
  void read_definitions() {
    const Statement rows = prepare_statement(
        database_.get(),
        "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions");
    const Statement hashes =
        prepare_statement(database_.get(), "SELECT id, type_description_hash FROM topics");
    while (hashes && sqlite3_step(hashes.get()) == SQLITE_ROW) {
      const auto place = places_.find(sqlite3_column_int64(hashes.get(), 0));
      if (place != places_.end()) topics_[place->second].type_hash = column_text(hashes.get(), 1);
    }
    while (rows && sqlite3_step(rows.get()) == SQLITE_ROW) {
      const std::string type = column_text(rows.get(), 0);
      for (BagTopic& topic : topics_) {
        if (topic.type != type) continue;
        topic.definition_encoding = column_text(rows.get(), 1);
        topic.definition = column_text(rows.get(), 2);
      }
    }
  }

  /// Stamps by a scan of the table, not of the index: what a damaged file still has comes out.
  void read_rows() {
    const Statement statement =
        prepare_statement(database_.get(), "SELECT timestamp, id FROM messages");
    if (!statement) refuse();
    int code = SQLITE_OK;
    while ((code = sqlite3_step(statement.get())) == SQLITE_ROW) {
      rows_.push_back(
          {sqlite3_column_int64(statement.get(), 0), sqlite3_column_int64(statement.get(), 1)});
    }
    if (code != SQLITE_DONE) {
      damage_.add(file_.string() + ": behind message " +
                  std::to_string(rows_.empty() ? 0 : rows_.back().id) + ": " +
                  fault_of(database_.get()));
      if (rows_.empty()) refuse();
    }
    std::sort(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) {
      return std::pair(a.stamp_ns, a.id) < std::pair(b.stamp_ns, b.id);
    });
  }

  fs::path file_;
  std::string description_ = "SQLite schema before 3";
  Database database_;
  Statement fetch_;
  std::vector<BagTopic> topics_;
  std::map<std::int64_t, std::size_t> places_;
  std::vector<Row> rows_;
  std::size_t next_ = 0;
  BagDamage damage_;
};

}  // namespace

std::unique_ptr<BagReader> open_sqlite_bag(const fs::path& file, const fs::path& shown) {
  return std::make_unique<SqliteBagReader>(file, shown);
}

}  // namespace strata::log
