// SPDX-License-Identifier: Apache-2.0
#include <cstdint>

#include "memory/store/detail/blob.hpp"
#include "memory/store/detail/store_impl.hpp"

namespace strata::memory {
namespace {

using detail::Database;
using detail::Statement;

void write_node(Database& database, const std::string& map, const TimescaleMemory& memory,
                std::size_t index) {
  const MemoryNode& node = memory.nodes()[index];
  const TimescaleMemory::NodeState state = memory.node_state(index);
  Statement(database,
            "INSERT INTO timescale_node (map, node, x_m, y_m, observations, data) "
            "VALUES (?, ?, ?, ?, ?, ?)")
      .bind(map)
      .bind(static_cast<std::int64_t>(index))
      .bind(node.position_m.x())
      .bind(node.position_m.y())
      .bind(static_cast<std::int64_t>(node.observations))
      .bind(state.head)
      .run();
  Statement insert(database,
                   "INSERT INTO timescale_level (map, node, level, name, half_life_s, samples, "
                   "pairs, data) VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t l = 0; l < node.levels.size(); ++l) {
    const LevelConfig& config = memory.config().levels[l];
    insert.bind(map).bind(static_cast<std::int64_t>(index)).bind(static_cast<std::int64_t>(l));
    insert.bind(config.name).bind(config.half_life_s);
    insert.bind(static_cast<std::int64_t>(node.levels[l].sample_count()));
    insert.bind(static_cast<std::int64_t>(node.levels[l].pair_count()));
    insert.bind(detail::compress(state.levels[l])).run();
  }
}

}  // namespace

void Store::save_timescale(const TimescaleMemory& memory, const std::string& name) {
  transaction([&] {
    Database& database = impl_->database;
    Statement(database, "DELETE FROM timescale WHERE name = ?").bind(name).run();
    Statement(database,
              "INSERT INTO timescale (name, nodes, observations, data) VALUES (?, ?, ?, ?)")
        .bind(name)
        .bind(static_cast<std::int64_t>(memory.nodes().size()))
        .bind(static_cast<std::int64_t>(memory.observations()))
        .bind(memory.head_state())
        .run();
    for (std::size_t n = 0; n < memory.nodes().size(); ++n) write_node(database, name, memory, n);
  });
}

TimescaleMemory Store::load_timescale(const std::string& name) const {
  Database& database = impl_->database;
  const detail::ReadScope scope(database);
  const std::string place = database.place() + ": timescale memory '" + name + "'";
  Statement head(database, "SELECT data FROM timescale WHERE name = ?");
  if (!head.bind(name).step()) {
    detail::throw_missing(database.place(), "timescale memory '" + name + "'");
  }
  const std::vector<std::byte> head_bytes = head.blob(0);
  std::vector<TimescaleMemory::NodeState> nodes;
  Statement rows(database, "SELECT node, data FROM timescale_node WHERE map = ? ORDER BY node");
  Statement levels(database,
                   "SELECT data FROM timescale_level WHERE map = ? AND node = ? ORDER BY level");
  rows.bind(name);
  while (rows.step()) {
    TimescaleMemory::NodeState& node = nodes.emplace_back();
    node.head = rows.blob(1);
    levels.bind(name).bind(rows.integer(0));
    while (levels.step()) node.levels.push_back(detail::decompress(levels.blob(0), place));
    levels.reset();
  }
  return TimescaleMemory::restore(head_bytes, nodes, place);
}

bool Store::has_timescale(const std::string& name) const {
  Statement statement(impl_->database, "SELECT 1 FROM timescale WHERE name = ?");
  return statement.bind(name).step();
}

}  // namespace strata::memory
