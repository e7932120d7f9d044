// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/base/damage.hpp"
#include "core/periodic/periodic_shares.hpp"
#include "memory/store/detail/store_impl.hpp"

namespace strata::memory {
namespace {

using detail::Database;
using detail::Statement;

std::string grid_name(const std::string& map, const std::string& part) {
  return "patch_map/" + map + "/" + part;
}

void remove_map(Database& database, const std::string& name) {
  // The grids are not reached by the cascade.
  const std::string prefix = grid_name(name, "");
  Statement(database, "DELETE FROM grid WHERE substr(name, 1, ?) = ?")
      .bind(static_cast<std::int64_t>(prefix.size()))
      .bind(prefix)
      .run();
  Statement(database, "DELETE FROM patch_map WHERE name = ?").bind(name).run();
}

void write_configurations(Database& database, const std::string& map, int place,
                          const patch::Submap& submap) {
  for (std::size_t c = 0; c < submap.configurations.size(); ++c) {
    const patch::Configuration& configuration = submap.configurations[c];
    const std::string part =
        "submap " + std::to_string(place) + "/configuration " + std::to_string(c);
    const std::string counts = grid_name(map, part + "/counts");
    const std::string reflection = grid_name(map, part + "/reflection");
    detail::write_grid(database, counts, configuration.counts);
    detail::write_grid(database, reflection, configuration.reflection);
    Statement(database,
              "INSERT INTO configuration (map, submap, place, prior, counts, reflection) "
              "VALUES (?, ?, ?, ?, ?, ?)")
        .bind(map)
        .bind(place)
        .bind(static_cast<int>(c))
        .bind(configuration.prior)
        .bind(counts)
        .bind(reflection)
        .run();
  }
}

void write_sequences(Database& database, const std::string& map, int place,
                     const patch::Submap& submap) {
  Statement insert(database,
                   "INSERT INTO sequence (map, submap, place, run, begin_ns, end_ns, scans) "
                   "VALUES (?, ?, ?, ?, ?, ?, ?)");
  Statement insert_membership(
      database,
      "INSERT INTO membership (map, submap, sequence, configuration, probability) "
      "VALUES (?, ?, ?, ?, ?)");
  for (std::size_t s = 0; s < submap.sequences.size(); ++s) {
    const patch::SequenceInfo& sequence = submap.sequences[s];
    insert.bind(map).bind(place).bind(static_cast<int>(s)).bind(sequence.run);
    insert.bind(sequence.begin.ns).bind(sequence.end.ns);
    insert.bind(static_cast<std::int64_t>(sequence.scans)).run();
    for (std::size_t c = 0; c < sequence.membership.size(); ++c) {
      insert_membership.bind(map).bind(place).bind(static_cast<int>(s));
      insert_membership.bind(static_cast<int>(c)).bind(sequence.membership[c]).run();
    }
  }
}

void write_submap(Database& database, const std::string& map, int place,
                  const patch::Submap& submap) {
  const std::string mask = grid_name(map, "submap " + std::to_string(place) + "/contradictory");
  detail::write_grid(database, mask, submap.contradictory);
  Statement(database,
            "INSERT INTO submap (map, place, id, min_x, min_y, max_x, max_y, contradictory) "
            "VALUES (?, ?, ?, ?, ?, ?, ?, ?)")
      .bind(map)
      .bind(place)
      .bind(submap.id)
      .bind(submap.rect.min.x)
      .bind(submap.rect.min.y)
      .bind(submap.rect.max.x)
      .bind(submap.rect.max.y)
      .bind(mask)
      .run();
  write_configurations(database, map, place, submap);
  write_sequences(database, map, place, submap);
}

void read_configurations(Database& database, const std::string& map, int place,
                         patch::Submap& submap) {
  Statement statement(database,
                      "SELECT prior, counts, reflection FROM configuration "
                      "WHERE map = ? AND submap = ? ORDER BY place");
  statement.bind(map).bind(place);
  while (statement.step()) {
    patch::Configuration configuration;
    configuration.prior = statement.real(0);
    configuration.counts = detail::read_grid<CellCounts>(database, statement.text(1));
    configuration.reflection = detail::read_grid<float>(database, statement.text(2));
    submap.configurations.push_back(std::move(configuration));
  }
}

void read_sequences(Database& database, const std::string& map, int place, patch::Submap& submap) {
  Statement statement(database,
                      "SELECT run, begin_ns, end_ns, scans FROM sequence "
                      "WHERE map = ? AND submap = ? ORDER BY place");
  Statement memberships(database,
                        "SELECT probability FROM membership WHERE map = ? AND submap = ? AND "
                        "sequence = ? ORDER BY configuration");
  statement.bind(map).bind(place);
  while (statement.step()) {
    patch::SequenceInfo sequence;
    sequence.run = static_cast<int>(statement.integer(0));
    sequence.begin = {statement.integer(1)};
    sequence.end = {statement.integer(2)};
    sequence.scans = static_cast<std::size_t>(statement.integer(3));
    memberships.bind(map).bind(place).bind(static_cast<int>(submap.sequences.size()));
    while (memberships.step()) sequence.membership.push_back(memberships.real(0));
    memberships.reset();
    submap.sequences.push_back(std::move(sequence));
  }
}

/// Stores of versions 1 and 2 that are only read do not have the tables.
bool has_chains(Database& database) {
  return database.query_integer(
             "SELECT count(*) FROM sqlite_master WHERE name IN ('patch_entry', 'submap_chain')") ==
         2;
}

void write_chains(Database& database, const std::string& name, const patch::PatchMap& map) {
  Statement(database, "INSERT INTO patch_entry (map, margin_m) VALUES (?, ?)")
      .bind(name)
      .bind(map.entry_margin_m)
      .run();
  Statement insert(database, "INSERT INTO submap_chain (map, submap, rate_per_s) VALUES (?, ?, ?)");
  for (std::size_t s = 0; s < map.submaps.size(); ++s) {
    insert.bind(name).bind(static_cast<int>(s)).bind(map.submaps[s].change_rate_per_s).run();
  }
}

void read_chains(Database& database, const std::string& name, patch::PatchMap& map) {
  if (!has_chains(database)) return;
  Statement entry(database, "SELECT margin_m FROM patch_entry WHERE map = ?");
  if (entry.bind(name).step()) map.entry_margin_m = entry.real(0);
  Statement rates(database, "SELECT submap, rate_per_s FROM submap_chain WHERE map = ?");
  rates.bind(name);
  while (rates.step()) {
    const std::int64_t place = rates.integer(0);
    if (place < 0 || place >= static_cast<std::int64_t>(map.submaps.size())) continue;
    map.submaps[static_cast<std::size_t>(place)].change_rate_per_s = rates.real(1);
  }
}

/// The logits of a sub-map's configurations, then each of its waves.
void write_waves(Database& database, const std::string& name, const patch::PatchMap& map) {
  Statement insert(database,
                   "INSERT INTO submap_wave (map, submap, place, cycles_a_week, configuration, "
                   "cosine, sine) VALUES (?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t s = 0; s < map.submaps.size(); ++s) {
    const periodic::PeriodicShares& usual = map.submaps[s].usual;
    if (!usual.is_periodic()) continue;
    for (std::size_t k = 0; k < usual.logit.size(); ++k) {
      const auto write = [&](std::size_t place, int cycles, double cosine, double sine) {
        insert.bind(name).bind(static_cast<int>(s)).bind(static_cast<int>(place)).bind(cycles);
        insert.bind(static_cast<int>(k)).bind(cosine).bind(sine).run();
      };
      write(0, 0, usual.logit[k], 0.0);
      for (std::size_t h = 0; h < usual.harmonics.size(); ++h) {
        const periodic::Harmonic& wave = usual.harmonics[h];
        write(h + 1, wave.cycles_a_week, wave.cosine[k], wave.sine[k]);
      }
    }
  }
}

/// Stores of versions 1 to 3 that are only read do not have the table.
void read_waves(Database& database, const std::string& name, patch::PatchMap& map) {
  if (database.query_integer("SELECT count(*) FROM sqlite_master WHERE name = 'submap_wave'") ==
      0) {
    return;
  }
  Statement waves(database,
                  "SELECT submap, place, cycles_a_week, cosine, sine FROM submap_wave "
                  "WHERE map = ? ORDER BY submap, place, configuration");
  waves.bind(name);
  std::pair<std::int64_t, std::int64_t> newest{-1, -1};
  while (waves.step()) {
    const std::int64_t place = waves.integer(0);
    if (place < 0 || place >= static_cast<std::int64_t>(map.submaps.size())) continue;
    periodic::PeriodicShares& usual = map.submaps[static_cast<std::size_t>(place)].usual;
    if (waves.integer(1) == 0) {
      usual.logit.push_back(waves.real(3));
      continue;
    }
    const std::pair wave{place, waves.integer(1)};
    if (std::exchange(newest, wave) != wave) {
      usual.harmonics.push_back({static_cast<int>(waves.integer(2)), {}, {}});
    }
    usual.harmonics.back().cosine.push_back(waves.real(3));
    usual.harmonics.back().sine.push_back(waves.real(4));
  }
  for (const patch::Submap& submap : map.submaps) {
    const bool fits =
        submap.usual.logit.empty() || submap.usual.logit.size() == submap.configurations.size();
    if (fits && periodic::is_sound(submap.usual)) continue;
    throw DamageError(database.place() + ": sub-map " + std::to_string(submap.id),
                      "what is usual there by the time does not fit it",
                      "take the store from a backup");
  }
}

/// Whether all grids lie on the sub-map's cells, and each sequence knows of each configuration.
bool is_sound(const patch::Submap& submap, double resolution_m) {
  const auto covers = [&](const auto& grid) {
    return grid.rect() == submap.rect && grid.resolution_m() == resolution_m;
  };
  const std::size_t count = submap.configurations.size();
  return covers(submap.contradictory) && count > 0 &&
         std::all_of(submap.configurations.begin(), submap.configurations.end(),
                     [&](const auto& configuration) {
                       return covers(configuration.counts) && covers(configuration.reflection);
                     }) &&
         std::all_of(submap.sequences.begin(), submap.sequences.end(), [&](const auto& sequence) {
           return sequence.membership.empty() || sequence.membership.size() == count;
         });
}

}  // namespace

void Store::save_patch_map(const patch::PatchMap& map, const std::string& name) {
  transaction([&] {
    Database& database = impl_->database;
    remove_map(database, name);
    const std::string base = grid_name(name, "base");
    detail::write_grid(database, base, map.base);
    Statement(database, "INSERT INTO patch_map (name, base) VALUES (?, ?)")
        .bind(name)
        .bind(base)
        .run();
    for (std::size_t s = 0; s < map.submaps.size(); ++s) {
      write_submap(database, name, static_cast<int>(s), map.submaps[s]);
    }
    write_chains(database, name, map);
    write_waves(database, name, map);
  });
}

patch::PatchMap Store::load_patch_map(const std::string& name) const {
  Database& database = impl_->database;
  const detail::ReadScope scope(database);
  Statement head(database, "SELECT base FROM patch_map WHERE name = ?");
  if (!head.bind(name).step()) {
    detail::throw_missing(database.place(), "patch map '" + name + "'");
  }
  patch::PatchMap map;
  map.base = detail::read_grid<float>(database, head.text(0));
  Statement statement(database,
                      "SELECT place, id, min_x, min_y, max_x, max_y, contradictory FROM submap "
                      "WHERE map = ? ORDER BY place");
  statement.bind(name);
  while (statement.step()) {
    auto integer = [&](int column) { return static_cast<int>(statement.integer(column)); };
    patch::Submap submap;
    submap.id = integer(1);
    submap.rect = {{integer(2), integer(3)}, {integer(4), integer(5)}};
    submap.contradictory = detail::read_grid<std::uint8_t>(database, statement.text(6));
    read_configurations(database, name, integer(0), submap);
    read_sequences(database, name, integer(0), submap);
    if (!is_sound(submap, map.base.resolution_m())) {
      throw DamageError(database.place() + ": sub-map " + std::to_string(submap.id),
                        "its configurations do not fit it", "take the store from a backup");
    }
    map.submaps.push_back(std::move(submap));
  }
  read_chains(database, name, map);
  read_waves(database, name, map);
  return map;
}

bool Store::has_patch_map(const std::string& name) const {
  Statement statement(impl_->database, "SELECT 1 FROM patch_map WHERE name = ?");
  return statement.bind(name).step();
}

}  // namespace strata::memory
