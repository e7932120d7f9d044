// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <optional>

#include "memory/store/detail/blob.hpp"
#include "memory/store/detail/store_impl.hpp"

namespace strata::memory {
namespace {

using detail::Database;
using detail::Statement;

void write_head(Database& database, const std::string& map, const TimescaleMemory& memory) {
  Statement(database,
            "INSERT INTO timescale (name, nodes, observations, data) VALUES (?, ?, ?, ?) "
            "ON CONFLICT (name) DO UPDATE SET nodes = excluded.nodes, "
            "observations = excluded.observations, data = excluded.data")
      .bind(map)
      .bind(static_cast<std::int64_t>(memory.nodes().size()))
      .bind(static_cast<std::int64_t>(memory.observations()))
      .bind(memory.head_state())
      .run();
}

std::vector<std::byte> read_head(Database& database, const std::string& map) {
  Statement head(database, "SELECT data FROM timescale WHERE name = ?");
  if (!head.bind(map).step()) {
    detail::throw_missing(database.place(), "timescale memory '" + map + "'");
  }
  return head.blob(0);
}

void write_level(Database& database, const std::string& map, std::size_t node, std::size_t place,
                 const LevelConfig& config, const NodeLevel& level,
                 const std::vector<std::byte>& state) {
  Statement(database,
            "INSERT INTO timescale_level (map, node, level, name, half_life_s, samples, pairs, "
            "data) VALUES (?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT (map, node, level) DO UPDATE SET "
            "name = excluded.name, half_life_s = excluded.half_life_s, samples = excluded.samples, "
            "pairs = excluded.pairs, data = excluded.data")
      .bind(map)
      .bind(static_cast<std::int64_t>(node))
      .bind(static_cast<std::int64_t>(place))
      .bind(config.name)
      .bind(config.nominal_half_life_s())
      .bind(static_cast<std::int64_t>(level.sample_count()))
      .bind(static_cast<std::int64_t>(level.pair_count()))
      .bind(detail::compress(state))
      .run();
}

/// Writes what differs from the revisions; empty: everything. node: that of the index, loaded.
/// Returns whether anything did.
bool write_node(Database& database, const std::string& map, const TimescaleMemory& memory,
                const MemoryNode& node, std::size_t index,
                const std::vector<std::uint64_t>& saved) {
  const std::vector<std::uint64_t> revisions = node.revisions();
  if (revisions == saved) return false;
  const bool is_new = saved.size() != revisions.size();
  const TimescaleMemory::NodeState state = memory.node_state(index);
  Statement(database,
            "INSERT INTO timescale_node (map, node, x_m, y_m, observations, data) "
            "VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT (map, node) DO UPDATE SET "
            "x_m = excluded.x_m, y_m = excluded.y_m, observations = excluded.observations, "
            "data = excluded.data")
      .bind(map)
      .bind(static_cast<std::int64_t>(index))
      .bind(node.position_m.x())
      .bind(node.position_m.y())
      .bind(static_cast<std::int64_t>(node.observations))
      .bind(state.head)
      .run();
  for (std::size_t l = 0; l < state.levels.size(); ++l) {
    if (!is_new && revisions[l + 1] == saved[l + 1]) continue;
    if (l < node.levels.size()) {
      write_level(database, map, index, l, memory.config().levels[l], node.levels[l],
                  state.levels[l]);
    } else {
      const LevelConfig today{"(today)", node.today->seen().capacity(), 0.0};
      write_level(database, map, index, l, today, node.today->seen(), state.levels[l]);
    }
  }
  return true;
}

}  // namespace

void Store::save_timescale(const TimescaleMemory& memory, const std::string& name) {
  transaction([&] {
    Database& database = impl_->database;
    write_head(database, name, memory);
    // Over what is there, which may be where evicted nodes are read from; what is too much goes
    // last.
    Statement surplus(database,
                      "DELETE FROM timescale_level WHERE map = ? AND node = ? AND level >= ?");
    for (std::size_t n = 0; n < memory.nodes().size(); ++n) {
      std::optional<MemoryNode> loaded;
      if (memory.nodes()[n].is_evicted()) loaded = memory.loaded(n);
      const MemoryNode& node = loaded ? *loaded : memory.nodes()[n];
      write_node(database, name, memory, node, n, {});
      surplus.bind(name)
          .bind(static_cast<std::int64_t>(n))
          .bind(static_cast<std::int64_t>(node.levels.size() + (node.today ? 1 : 0)))
          .run();
    }
    Statement(database, "DELETE FROM timescale_node WHERE map = ? AND node >= ?")
        .bind(name)
        .bind(static_cast<std::int64_t>(memory.nodes().size()))
        .run();
  });
}

SavedTimescale Store::all_saved(const TimescaleMemory& memory) {
  SavedTimescale saved{true, memory.observations(), {}};
  for (const MemoryNode& node : memory.nodes()) {
    saved.nodes.push_back(node.is_evicted() ? std::vector<std::uint64_t>() : node.revisions());
  }
  return saved;
}

std::size_t Store::save_timescale_changes(const TimescaleMemory& memory, SavedTimescale& saved,
                                          const std::string& name) {
  std::size_t written = 0;
  transaction([&] {
    Database& database = impl_->database;
    Statement head(database, "SELECT observations FROM timescale WHERE name = ?");
    const bool is_there = head.bind(name).step();
    const auto stored = is_there ? static_cast<std::uint64_t>(head.integer(0)) : 0U;
    if (is_there != saved.is_known || stored != saved.observations) {
      throw OutputError(database.place(),
                        "another program has written the timescale memory '" + name + "'",
                        "let one program write it at a time, or give each its own store");
    }
    head.reset();
    write_head(database, name, memory);
    for (std::size_t n = 0; n < memory.nodes().size(); ++n) {
      const MemoryNode& node = memory.nodes()[n];
      if (node.is_evicted()) continue;  // it was saved before it was evicted, or came from here
      std::vector<std::uint64_t> there;
      if (n < saved.nodes.size()) {
        there = saved.nodes[n].empty() ? node.stored_revisions : saved.nodes[n];
      }
      written += write_node(database, name, memory, node, n, there) ? 1 : 0;
    }
  });
  saved = all_saved(memory);
  return written;
}

TimescaleMemory Store::load_timescale(const std::string& name) const {
  Database& database = impl_->database;
  const detail::ReadScope scope(database);
  const std::string place = database.place() + ": timescale memory '" + name + "'";
  const std::vector<std::byte> head = read_head(database, name);
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
  return TimescaleMemory::restore(head, nodes, place);
}

namespace {

/// Reads through the connection of the store that made it, which it keeps open.
class StoredNodes final : public NodeSource {
 public:
  StoredNodes(std::shared_ptr<Database> database, std::string name)
      : database_(std::move(database)), name_(std::move(name)) {}

  [[nodiscard]] std::vector<std::vector<std::byte>> levels_of(std::size_t node) const override {
    Statement rows(*database_,
                   "SELECT data FROM timescale_level WHERE map = ? AND node = ? ORDER BY level");
    rows.bind(name_).bind(static_cast<std::int64_t>(node));
    std::vector<std::vector<std::byte>> levels;
    while (rows.step()) levels.push_back(detail::decompress(rows.blob(0), place()));
    return levels;
  }
  [[nodiscard]] std::string place() const override {
    return database_->place() + ": timescale memory '" + name_ + "'";
  }

 private:
  std::shared_ptr<Database> database_;
  std::string name_;
};

}  // namespace

std::shared_ptr<const NodeSource> Store::timescale_nodes(const std::string& name) const {
  return std::make_shared<const StoredNodes>(std::shared_ptr<Database>(impl_, &impl_->database),
                                             name);
}

TimescaleMemory Store::open_timescale(const std::string& name) const {
  Database& database = impl_->database;
  const detail::ReadScope scope(database);
  const std::vector<std::byte> head = read_head(database, name);
  std::vector<std::vector<std::byte>> nodes;
  Statement rows(database, "SELECT data FROM timescale_node WHERE map = ? ORDER BY node");
  rows.bind(name);
  while (rows.step()) nodes.push_back(rows.blob(0));
  return TimescaleMemory::restore_evicted(head, nodes, timescale_nodes(name));
}

bool Store::has_timescale(const std::string& name) const {
  Statement statement(impl_->database, "SELECT 1 FROM timescale WHERE name = ?");
  return statement.bind(name).step();
}

}  // namespace strata::memory
