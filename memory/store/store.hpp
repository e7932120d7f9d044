// SPDX-License-Identifier: Apache-2.0
/// Everything that must survive, in one SQLite file (strata.db): grids, the patch map, the
/// timescale memory, trajectories, scans, and texts.
///
/// Each save is one transaction: after a crash a reader finds the old value or the new one, never a
/// mixture. Several programs may write to one file, one after the other; a writer waits for the
/// other up to `busy_timeout_ms`. Values come back bit for bit.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base/time.hpp"
#include "core/geometry/pose2.hpp"
#include "core/grid/counting_map.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/grid/surface_layer.hpp"
#include "core/patch/patch_map.hpp"
#include "core/scan/scan.hpp"
#include "memory/nodes/timescale_memory.hpp"

namespace strata::memory {

/// How a store is opened.
struct StoreOptions {
  bool read_only = false;  ///< the file must exist; every save throws OutputError
  int busy_timeout_ms = 10'000;
  bool check = true;  ///< look for damage when opening (reads the whole file once)
};

/// One scan's pose of a run's trajectory.
struct TrajectoryPose {
  Stamp stamp;
  Pose2 map_from_robot;
  /// Of (x, y, theta) in the map frame, when the estimator gave one.
  std::optional<Eigen::Matrix3d> covariance;
};

/// What a store holds already of a memory that is saved again and again. A new one: nothing.
struct SavedTimescale {
  bool is_known = false;  ///< the rest says what the store holds
  std::uint64_t observations = 0;
  /// Per node its revisions; none for one that was evicted.
  std::vector<std::vector<std::uint64_t>> nodes;
};

/// One open store. Errors: InputError for a file that is missing, of another program or of a newer
/// version, and for a name that is not there; of those DamageError for a store that is damaged and
/// UnknownContentError for a file that SQLite cannot read; OutputError when writing fails. One
/// thread at a time.
class Store {
 public:
  explicit Store(const std::filesystem::path& path, const StoreOptions& options = {});
  /// Folds the write-ahead log back, so that one file remains, unless a memory from open_timescale
  /// lives on, or the store is damaged.
  ~Store();
  Store(Store&&) noexcept;
  Store& operator=(Store&&) noexcept;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// What was read from it turned out to be damaged: its files stay byte for byte as they are.
  void leave_as_is();
  /// Reads everything once. Opening finds a file that is torn; this, values that are not what was
  /// saved. Throws DamageError at the first. O(contents).
  void check_contents() const;

  /// Runs `body` as one transaction: all of its saves or, when it throws, none. One inside another
  /// is undone alone when it throws; what it saved is in the file when the outer one ends.
  void transaction(const std::function<void()>& body);

  /// Texts by key, e.g. "summary/em" or "config/learn". Keys are the caller's.
  void save_text(const std::string& key, const std::string& value);
  [[nodiscard]] std::optional<std::string> find_text(const std::string& key) const;
  /// Keys that begin with `prefix`, sorted.
  [[nodiscard]] std::vector<std::string> text_keys(const std::string& prefix = "") const;

  /// Grids by name, e.g. "filtered"; a later save replaces. O(cells), zstd-compressed.
  void save_grid(const std::string& name, const ReflectionGrid& grid);
  void save_grid(const std::string& name, const Grid<CellCounts>& grid);
  void save_grid(const std::string& name, const TiledGrid<CellCounts>& grid);
  /// Where in the cells of the grid `name` surfaces lie: about 5 bytes a cell that has one.
  void save_surfaces(const std::string& name, const SurfaceLayer& layer);
  /// An empty layer where there is none, as in stores of before.
  [[nodiscard]] SurfaceLayer load_surfaces(const std::string& name) const;
  [[nodiscard]] ReflectionGrid load_reflection_grid(const std::string& name) const;
  [[nodiscard]] Grid<CellCounts> load_counts_grid(const std::string& name) const;
  [[nodiscard]] bool has_grid(const std::string& name) const;
  /// Names of the grids saved by save_grid, sorted.
  [[nodiscard]] std::vector<std::string> grid_names() const;

  /// The patch map with all sub-maps, configurations, counts and sequences.
  void save_patch_map(const patch::PatchMap& map, const std::string& name = "patch");
  [[nodiscard]] patch::PatchMap load_patch_map(const std::string& name = "patch") const;
  [[nodiscard]] bool has_patch_map(const std::string& name = "patch") const;

  /// The timescale memory; what is loaded goes on exactly as what was saved would have.
  void save_timescale(const TimescaleMemory& memory, const std::string& name = "timescale");
  [[nodiscard]] TimescaleMemory load_timescale(const std::string& name = "timescale") const;
  /// The same memory with all its nodes evicted: each is read when it is needed, through this
  /// store's connection, which stays open until the memory is gone too (one thread for both).
  /// Damage in a node is found, as an InputError, when it is loaded. O(nodes), a few milliseconds
  /// for 10,000.
  [[nodiscard]] TimescaleMemory open_timescale(const std::string& name = "timescale") const;
  /// Where nodes may be evicted to (TimescaleMemory::evict) right after they were saved.
  [[nodiscard]] std::shared_ptr<const NodeSource> timescale_nodes(
      const std::string& name = "timescale") const;
  /// Brings what the store holds of the memory up to date: one transaction with the nodes and
  /// levels that have changed since `saved`, which says afterwards what is there now. For saving as
  /// the robot runs: after a crash the store holds the last state that this returned from, or a
  /// newer one. Returns how many nodes it wrote. Throws OutputError, without a change to store or
  /// `saved`, when writing fails or another program has written this memory in between.
  std::size_t save_timescale_changes(const TimescaleMemory& memory, SavedTimescale& saved,
                                     const std::string& name = "timescale");
  /// What `saved` is right after loading or saving this memory as a whole.
  [[nodiscard]] static SavedTimescale all_saved(const TimescaleMemory& memory);
  [[nodiscard]] bool has_timescale(const std::string& name = "timescale") const;

  /// The trajectory of one run, in the given order; replaces what the run had.
  void save_trajectory(int run, std::span<const TrajectoryPose> poses);
  /// Empty for a run that is not there.
  [[nodiscard]] std::vector<TrajectoryPose> load_trajectory(int run) const;
  /// The runs that have a trajectory, sorted.
  [[nodiscard]] std::vector<int> runs() const;

  /// The scans of one run with their poses and beam labels, in the given order, so that learning
  /// can go on from them; replaces what the run had. About 1 byte a beam; O(beams).
  void save_scans(int run, std::span<const PosedScan> scans);
  /// Adds scans to those of the run: for writing as they come. Many at a time compress better.
  void append_scans(int run, std::span<const PosedScan> scans);
  /// Empty for a run that is not there, and in stores of before version 2.
  [[nodiscard]] std::vector<PosedScan> load_scans(int run) const;
  /// The runs that have scans, sorted.
  [[nodiscard]] std::vector<int> runs_with_scans() const;

 private:
  struct Impl;
  void require_writable() const;

  std::filesystem::path path_;
  std::shared_ptr<Impl> impl_;  // a memory whose nodes are evicted holds on to it
};

}  // namespace strata::memory
