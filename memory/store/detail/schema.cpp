// SPDX-License-Identifier: Apache-2.0
#include "memory/store/detail/schema.hpp"

#include "core/base/error.hpp"

namespace strata::memory::detail {
namespace {

// Dense numbers are zstd frames ("data"); everything one may want to ask about is a column.
constexpr const char* kTables = R"sql(
CREATE TABLE text (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE grid (
  name TEXT PRIMARY KEY, kind TEXT NOT NULL, resolution_m REAL NOT NULL,
  min_x INTEGER NOT NULL, min_y INTEGER NOT NULL, max_x INTEGER NOT NULL, max_y INTEGER NOT NULL,
  fill BLOB NOT NULL, data BLOB NOT NULL);
CREATE TABLE patch_map (name TEXT PRIMARY KEY, base TEXT NOT NULL);
CREATE TABLE submap (
  map TEXT NOT NULL REFERENCES patch_map(name) ON DELETE CASCADE, place INTEGER NOT NULL,
  id INTEGER NOT NULL, min_x INTEGER NOT NULL, min_y INTEGER NOT NULL, max_x INTEGER NOT NULL,
  max_y INTEGER NOT NULL, contradictory TEXT NOT NULL, PRIMARY KEY (map, place));
CREATE TABLE configuration (
  map TEXT NOT NULL, submap INTEGER NOT NULL, place INTEGER NOT NULL, prior REAL,
  counts TEXT NOT NULL, reflection TEXT NOT NULL, PRIMARY KEY (map, submap, place),
  FOREIGN KEY (map, submap) REFERENCES submap(map, place) ON DELETE CASCADE);
CREATE TABLE sequence (
  map TEXT NOT NULL, submap INTEGER NOT NULL, place INTEGER NOT NULL, run INTEGER NOT NULL,
  begin_ns INTEGER NOT NULL, end_ns INTEGER NOT NULL, scans INTEGER NOT NULL,
  PRIMARY KEY (map, submap, place),
  FOREIGN KEY (map, submap) REFERENCES submap(map, place) ON DELETE CASCADE);
CREATE TABLE membership (
  map TEXT NOT NULL, submap INTEGER NOT NULL, sequence INTEGER NOT NULL,
  configuration INTEGER NOT NULL, probability REAL,
  PRIMARY KEY (map, submap, sequence, configuration),
  FOREIGN KEY (map, submap, sequence) REFERENCES sequence(map, submap, place) ON DELETE CASCADE)
  WITHOUT ROWID;
CREATE TABLE pose (
  run INTEGER NOT NULL, place INTEGER NOT NULL, stamp_ns INTEGER NOT NULL, x_m REAL, y_m REAL,
  theta_rad REAL, covariance BLOB, PRIMARY KEY (run, place)) WITHOUT ROWID;
CREATE TABLE timescale (
  name TEXT PRIMARY KEY, nodes INTEGER NOT NULL, observations INTEGER NOT NULL,
  data BLOB NOT NULL);
CREATE TABLE timescale_node (
  map TEXT NOT NULL REFERENCES timescale(name) ON DELETE CASCADE, node INTEGER NOT NULL,
  x_m REAL NOT NULL, y_m REAL NOT NULL, observations INTEGER NOT NULL, data BLOB NOT NULL,
  PRIMARY KEY (map, node));
CREATE TABLE timescale_level (
  map TEXT NOT NULL, node INTEGER NOT NULL, level INTEGER NOT NULL, name TEXT NOT NULL,
  half_life_s REAL NOT NULL, samples INTEGER NOT NULL, pairs INTEGER NOT NULL, data BLOB NOT NULL,
  PRIMARY KEY (map, node, level),
  FOREIGN KEY (map, node) REFERENCES timescale_node(map, node) ON DELETE CASCADE);
)sql";

/// New in version 2: the scans that the maps were learned from.
constexpr const char* kScanTables = R"sql(
CREATE TABLE scan_chunk (
  run INTEGER NOT NULL, place INTEGER NOT NULL, scans INTEGER NOT NULL, begin_ns INTEGER NOT NULL,
  end_ns INTEGER NOT NULL, data BLOB NOT NULL, PRIMARY KEY (run, place));
)sql";

/// New in version 3: how patch maps change, and from where their sub-maps count as entered.
constexpr const char* kChainTables = R"sql(
CREATE TABLE IF NOT EXISTS patch_entry (
  map TEXT PRIMARY KEY REFERENCES patch_map(name) ON DELETE CASCADE, margin_m REAL NOT NULL);
CREATE TABLE IF NOT EXISTS submap_chain (
  map TEXT NOT NULL, submap INTEGER NOT NULL, rate_per_s REAL NOT NULL,
  PRIMARY KEY (map, submap),
  FOREIGN KEY (map, submap) REFERENCES submap(map, place) ON DELETE CASCADE);
)sql";

/// New in version 4: what is usual of a sub-map by the time of day and week. cycles_a_week 0: the
/// logits.
constexpr const char* kWaveTables = R"sql(
CREATE TABLE IF NOT EXISTS submap_wave (
  map TEXT NOT NULL, submap INTEGER NOT NULL, place INTEGER NOT NULL,
  cycles_a_week INTEGER NOT NULL, configuration INTEGER NOT NULL, cosine REAL NOT NULL,
  sine REAL NOT NULL, PRIMARY KEY (map, submap, place, configuration),
  FOREIGN KEY (map, submap) REFERENCES submap(map, place) ON DELETE CASCADE);
)sql";

/// Holds the write lock while the tables are made, so that two programs may open a new file at
/// once.
void create_tables(Database& database) {
  database.execute_patiently("PRAGMA journal_mode = WAL");
  database.execute("BEGIN IMMEDIATE");
  if (database.query_integer("PRAGMA user_version") == 0) {
    database.execute(kTables);
    database.execute(kScanTables);
    database.execute(kChainTables);
    database.execute(kWaveTables);
    database.execute(("PRAGMA application_id = " + std::to_string(kApplicationId)).c_str());
    database.execute(("PRAGMA user_version = " + std::to_string(kSchemaVersion)).c_str());
  }
  database.execute("COMMIT");
}

/// Brings the tables of an older version up to the present one, in one transaction.
void upgrade(Database& database) {
  database.execute("BEGIN IMMEDIATE");
  const std::int64_t version = database.query_integer("PRAGMA user_version");
  if (version < 2) database.execute(kScanTables);
  if (version < 3) database.execute(kChainTables);
  if (version < 4) database.execute(kWaveTables);
  database.execute(("PRAGMA user_version = " + std::to_string(kSchemaVersion)).c_str());
  database.execute("COMMIT");
}

}  // namespace

void prepare_schema(Database& database) {
  const std::int64_t tables = database.query_integer("SELECT count(*) FROM sqlite_master");
  if (tables == 0 && !database.read_only()) {
    create_tables(database);
  }
  if (database.query_integer("PRAGMA application_id") != kApplicationId) {
    throw InputError(database.place(), "is an SQLite file but not a Strata store",
                     "give the strata.db of a maps folder");
  }
  const std::int64_t version = database.query_integer("PRAGMA user_version");
  if (version > kSchemaVersion) {
    throw InputError(database.place(),
                     "was written by a newer Strata (store version " + std::to_string(version) +
                         ", this one reads up to " + std::to_string(kSchemaVersion) + ")",
                     "update Strata, or learn the maps again with this version");
  }
  if (!database.read_only()) {
    if (version < kSchemaVersion) upgrade(database);
    database.execute("PRAGMA foreign_keys = ON");
    // With write-ahead logging this survives a crash of the program; a power cut may lose the last
    // transactions but never damages the file.
    database.execute("PRAGMA synchronous = NORMAL");
  }
}

}  // namespace strata::memory::detail
