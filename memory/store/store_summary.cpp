// SPDX-License-Identifier: Apache-2.0
#include "memory/store/store_summary.hpp"

#include <array>
#include <cstddef>
#include <fstream>
#include <map>
#include <string_view>

#include "core/base/error.hpp"
#include "memory/store/detail/database.hpp"
#include "memory/store/detail/schema.hpp"

namespace strata::memory {
namespace {

using detail::Database;
using detail::Statement;

constexpr int kBusyTimeoutMs = 10'000;

bool has_table(Database& database, const char* name) {
  Statement statement(database, "SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = ?");
  return statement.bind(std::string(name)).step();
}

void read_grids(Database& database, StoreSummary& summary) {
  Statement rows(database,
                 "SELECT name, resolution_m, max_x - min_x, max_y - min_y, length(data) FROM grid "
                 "ORDER BY name");
  while (rows.step()) {
    const double resolution_m = rows.real(1);
    summary.grids.push_back({rows.text(0), resolution_m,
                             resolution_m * static_cast<double>(rows.integer(2)),
                             resolution_m * static_cast<double>(rows.integer(3)), rows.integer(4)});
  }
}

void read_patch_maps(Database& database, StoreSummary& summary) {
  Statement rows(database,
                 "SELECT name, (SELECT count(*) FROM submap WHERE map = name), "
                 "(SELECT count(*) FROM configuration WHERE map = name), "
                 "(SELECT count(*) FROM sequence WHERE map = name) FROM patch_map ORDER BY name");
  while (rows.step()) {
    summary.patch_maps.push_back({rows.text(0), rows.integer(1), rows.integer(2), rows.integer(3)});
  }
  // Not in stores of versions 1 to 3.
  if (database.query_integer("SELECT count(*) FROM sqlite_master WHERE name = 'submap_wave'") ==
      0) {
    return;
  }
  Statement waves(database, "SELECT count(DISTINCT submap) FROM submap_wave WHERE map = ?");
  for (StoreSummary::PatchMap& map : summary.patch_maps) {
    if (waves.bind(map.name).step()) map.in_time = waves.integer(0);
    waves.reset();
  }
}

void read_runs(Database& database, StoreSummary& summary) {
  std::map<std::int64_t, StoreSummary::Run> runs;
  Statement poses(database, "SELECT run, count(*) FROM pose GROUP BY run");
  while (poses.step()) runs[poses.integer(0)].poses = poses.integer(1);
  if (has_table(database, "scan_chunk")) {
    Statement scans(database,
                    "SELECT run, sum(scans), sum(length(data)) FROM scan_chunk GROUP BY run");
    while (scans.step()) {
      runs[scans.integer(0)].scans = scans.integer(1);
      runs[scans.integer(0)].bytes = scans.integer(2);
    }
  }
  for (auto& [number, run] : runs) {
    run.run = number;
    summary.runs.push_back(run);
  }
}

void read_timescales(Database& database, StoreSummary& summary) {
  Statement rows(database, "SELECT name, nodes, observations FROM timescale ORDER BY name");
  Statement levels(database,
                   "SELECT name, half_life_s, sum(samples), sum(pairs), sum(length(data)), "
                   "max(length(data)) FROM timescale_level WHERE map = ? GROUP BY level");
  while (rows.step()) {
    StoreSummary::Timescale memory{rows.text(0), rows.integer(1), rows.integer(2), {}};
    levels.bind(memory.name);
    while (levels.step()) {
      memory.levels.push_back({levels.text(0), levels.real(1), levels.integer(2), levels.integer(3),
                               levels.integer(4), levels.integer(5)});
    }
    levels.reset();
    summary.timescales.push_back(std::move(memory));
  }
}

std::int64_t size_of(const std::filesystem::path& path) {
  std::error_code missing;
  const auto size = std::filesystem::file_size(path, missing);
  return missing ? 0 : static_cast<std::int64_t>(size);
}

/// A store that is being written may have all it holds, its id too, in its write-ahead log.
bool is_store_by_its_log(const std::filesystem::path& path) {
  if (size_of(path.string() + "-wal") == 0) return false;
  try {
    Database database(path, true, kBusyTimeoutMs);
    database.leave_log();  // it may be somebody else's
    return database.query_integer("PRAGMA application_id") == detail::kApplicationId;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

bool is_store(const std::filesystem::path& path) {
  // The application id lies at byte 68 of an SQLite file, the most significant byte first.
  constexpr std::string_view kMagic("SQLite format 3\0", 16);
  std::array<char, 72> head{};
  std::ifstream in(path, std::ios::binary);
  in.read(head.data(), head.size());
  if (!in && in.gcount() > 0) return false;
  if (in && std::string_view(head.data(), kMagic.size()) != kMagic) return false;
  std::int64_t id = 0;
  for (std::size_t i = 68; i < 72; ++i) id = id * 256 + static_cast<unsigned char>(head[i]);
  return id == detail::kApplicationId || is_store_by_its_log(path);
}

StoreSummary summarize_store(const std::filesystem::path& path) {
  Database database(path, true, kBusyTimeoutMs);
  detail::prepare_schema(database);
  StoreSummary summary;
  summary.version = database.query_integer("PRAGMA user_version");
  summary.file_bytes = size_of(path) + size_of(path.string() + "-wal");
  Statement texts(database, "SELECT key FROM text ORDER BY key");
  while (texts.step()) summary.texts.push_back(texts.text(0));
  read_grids(database, summary);
  read_patch_maps(database, summary);
  read_runs(database, summary);
  read_timescales(database, summary);
  return summary;
}

}  // namespace strata::memory
