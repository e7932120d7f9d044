// SPDX-License-Identifier: Apache-2.0
/// Scans and odometry in; poses, maps and beam labels out [stachniss2003chapter, section 1.2].
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/beam_filter/config.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/grid/counting_map.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/grid/surface_layer.hpp"
#include "core/scan/drop_outs.hpp"
#include "core/scan/scan.hpp"
#include "core/slam/consistency.hpp"
#include "core/slam/keep_config.hpp"
#include "core/slam/slam_config.hpp"

namespace strata::slam {

struct SlamConfig {
  TrackingConfig tracking;
  ClosureConfig closure;
  GivenPoseConfig given_poses;
  EmConfig em;
  NoReturnConfig no_return;
  beam_filter::BeamFilterConfig beam_filter;  ///< its resolution is that of every map here
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("tracking", c.tracking, "incremental scan matching");
    v.group("closure", c.closure, "loop closures");
    v.group("given_poses", c.given_poses, "poses that come with the log");
    v.group("em", c.em, "the loop over beam labels, poses and map");
    v.group("no_return", c.no_return, "what beams without return say");
    v.group("beam_filter", c.beam_filter,
            "which beams are static; its resolution and counting hold for all maps of slam");
  }
};

struct SlamResult {
  /// Every scan that was not skipped, nor forgotten (KeepConfig), in the order of `add`.
  std::vector<PosedScan> scans;
  CountingMap raw;                     ///< counts of all beams
  ReflectionGrid occupancy;            ///< reflection of all beams
  ReflectionGrid filtered;             ///< reflection of the beams held to be static
  DropOuts drop_outs;                  ///< what beams without return are taken for
  SurfaceLayer surfaces;               ///< where in the cells the static hits lie
  std::vector<double> log_likelihood;  ///< of the data, per EM iteration [nats]
  int iterations = 0;                  ///< EM iterations done
  double dynamic_fraction = 0.0;       ///< share of hits held to be dynamic
  std::size_t skipped_scans = 0;
  std::size_t loop_closures = 0;
  /// Runs that could not be placed in the map of the first one; their scans are left out.
  std::vector<int> unplaced_runs;
  /// What was skipped, not believed or ambiguous, one sentence each; empty for a healthy log.
  std::vector<std::string> warnings;
  Consistency consistency;  ///< of what was seen on different ways
};

/// Incremental SLAM with an explicit finish: `add` tracks and closes loops, `finish` does what
/// needs all the data. Not thread-safe; two objects are independent. The result is the same bits
/// for any number of threads.
class Slam {
 public:
  /// Throws ConfigError. threads: for the work inside; 0: one per core. keep: by default
  /// everything, in memory linear in scans.
  explicit Slam(const SlamConfig& config, int threads = 1, const KeepConfig& keep = {});
  ~Slam();
  Slam(const Slam&) = delete;
  Slam& operator=(const Slam&) = delete;

  /// The next scan of a run; a change of run id starts the next run, which is localized in the map
  /// of the earlier ones (by its given poses, else by search). A scan without a single valid
  /// reading, with a stamp before the last one of its run, that repeats the last one, or with
  /// odometry or a given pose that is not finite is skipped and counted. Returns map_from_robot as
  /// known now; `finish` may move it.
  Pose2Gaussian add(const Observation& observation, const Pose2* given_pose = nullptr);

  /// The next scan of a run that an earlier job placed, in the order of its runs and before any
  /// other: its pose is final, and scans added later are placed in the map of it. Its labels are
  /// estimated anew.
  void add_placed(const PosedScan& posed);

  /// Ends the last run and makes the maps, of the scans that were kept. Once some were forgotten
  /// the rest is not tracked again, whatever em.track_again says; nor does tracking again replace
  /// what was before where its passes contradict each other and no less. A map whose passes
  /// contradict each other (Consistency) is warned of. Call once. Throws Cancelled.
  [[nodiscard]] SlamResult finish(Progress* progress = nullptr);

  /// The run that comes next begins there, unless it comes with poses: it is not looked for in the
  /// map as a whole, but matched to what it sees near there.
  void begin_next_run_at(const Pose2Gaussian& map_from_robot);

  /// What a process goes on with after it was stopped: restored into a new object with the same
  /// config, it adds and finishes to the same bits as this one. Not after finish. O(what is kept).
  [[nodiscard]] std::vector<std::uint8_t> save_state() const;
  /// Throws InputError for bytes that are no state or of another resolution; the object is then of
  /// no more use. place: of the bytes, for errors.
  void restore_state(std::span<const std::uint8_t> bytes, const std::string& place);
  /// The newest scan: its run, stamp, odometry and pose as known now.
  struct Newest {
    int run = 0;
    Stamp stamp;
    std::optional<Pose2> odom_from_robot;
    Pose2 map_from_robot;
    /// Whether its run has its place in the map; until then the pose is in a frame of the run.
    bool is_placed = true;
  };
  /// Nothing before the first scan.
  [[nodiscard]] std::optional<Newest> newest() const;

  /// A scan of the map, and where it was taken as far as that is known now.
  struct Mapped {
    std::size_t number = 0;  ///< of all scans that were accepted
    const PosedScan* scan = nullptr;
    Pose2 map_from_robot;
  };
  /// Those that are kept, by number, but for those of runs that are not placed yet. Before finish.
  /// O(what is kept).
  void visit_mapped(const std::function<void(const Mapped&)>& visit) const;
  /// As above, with the scans that are kept and did not enter the map.
  void visit_kept(const std::function<void(const Mapped&)>& visit) const;

  [[nodiscard]] std::size_t skipped_scans() const;
  /// What is kept now.
  [[nodiscard]] std::size_t kept_scans() const;
  [[nodiscard]] std::size_t kept_local_maps() const;
  /// What this object, and none that it was restored from, has forgotten of runs that ended without
  /// a place in the map (KeepConfig).
  struct Unplaced {
    std::size_t runs = 0;
    std::size_t scans = 0;
  };
  [[nodiscard]] Unplaced forgotten_unplaced() const;

 private:
  struct State;
  [[nodiscard]] SlamResult finish_passes(Progress* progress);
  [[nodiscard]] SlamResult finish_usual_passes(Progress* progress);
  /// Another pass over what was added, with the labels of that result.
  [[nodiscard]] SlamResult track_anew(SlamResult result, const ClosureConfig& closure,
                                      Progress* progress);
  std::unique_ptr<State> state_;
};

}  // namespace strata::slam
