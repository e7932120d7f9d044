// SPDX-License-Identifier: Apache-2.0
/// Local maps of all runs, connected by what they see of each other.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/base/progress.hpp"
#include "core/pose_graph/pose_graph.hpp"
#include "core/slam/keep_config.hpp"
#include "core/slam/local_map_agreement.hpp"
#include "core/slam/slam_config.hpp"
#include "core/tracking/local_map.hpp"

namespace strata::slam {

/// Pose graph over local maps. A new local map gets an edge to its predecessor in the run; then it
/// is looked for in older local maps: those it may overlap given how far the path between them can
/// have drifted, by correlative search, refined by matching, and accepted when the space both have
/// seen agrees both ways. The pull of a closure fades when the others contradict it (robust
/// kernel), and it is dropped when it stays contradicted.
class LocalMapGraph {
 public:
  LocalMapGraph(const ClosureConfig& config, const registration::MatchConfig& match,
                const registration::MatchFieldConfig& field, double resolution_m, WorkerPool& pool);
  ~LocalMapGraph();

  /// Adds the next local map of its run; runs must not interleave. given_map_from_local_map: where
  /// given poses put it, with that uncertainty. Returns its index.
  std::size_t add(LocalMap local_map, const std::optional<Pose2Gaussian>& given_map_from_local_map);

  /// Tells that the run is complete: one that is not located yet is searched for as a whole.
  void end_run();

  /// Takes out the local maps of scans before that one which later ones have made superfluous
  /// (KeepConfig); what they said of those that stay is passed on. Returns their indices,
  /// ascending; those above move down. O(cells / 211 x local maps) for each local map that may
  /// overlap the newest one.
  std::vector<std::size_t> forget(const KeepConfig& keep, std::size_t before_scan);

  /// Takes out the runs before the newest one that ended without a place in the map, each once all
  /// of its scans are before that one: nothing is searched in them any more. Their indices, as
  /// above. O(local maps).
  std::vector<std::size_t> forget_unplaced(std::size_t before_scan);

  /// Registers every pair of overlapping local maps anew from the present poses, replaces
  /// all closures by the outcome, and optimizes [lu1997globally]; `rounds` times.
  void tighten(int rounds, Progress* progress);

  /// Gives back what the local maps see, which only closures ask for: no more are to come.
  void forget_surfaces();

  [[nodiscard]] std::size_t size() const { return local_maps_.size(); }
  [[nodiscard]] const LocalMap& local_map(std::size_t index) const { return local_maps_[index]; }
  [[nodiscard]] const Pose2& map_from_local_map(std::size_t index) const {
    return graph_.pose(index);
  }
  /// Takes the run's drifting frame to the map as the local map has it.
  [[nodiscard]] Pose2 map_from_run(std::size_t index) const {
    return graph_.pose(index) * inverse(local_maps_[index].run_from_local_map);
  }
  [[nodiscard]] std::size_t closures() const;
  /// Whether the local map is connected to the first run (or to given poses).
  [[nodiscard]] bool located(std::size_t index) const { return located_[index]; }

  /// For saved states; everything but what can be made again is the constructor's.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.local_maps_);
    archive(self.clouds_);
    if constexpr (Archive::kReads) self.measure_breadths();
    archive(self.given_);
    archive(self.located_);
    archive(self.chain_);
    archive(self.graph_);
  }
  /// Whether all of it fits together; else a state was damaged.
  [[nodiscard]] bool is_sound() const;

 private:
  struct Searchable;
  struct Closure {
    std::size_t a = 0;
    std::size_t b = 0;
    Pose2Gaussian a_from_b;
  };
  [[nodiscard]] std::shared_ptr<const Searchable> searchable(std::size_t index);
  [[nodiscard]] Agreement agreement(std::size_t a, std::size_t b, const Pose2& a_from_b) const;
  [[nodiscard]] bool run_fits_map(std::size_t first, std::size_t last) const;
  [[nodiscard]] std::vector<double> path_lengths(std::size_t from) const;
  /// Whether a closure could not move it: its pose was given more surely than any closure is.
  [[nodiscard]] bool is_settled(std::size_t index) const;
  [[nodiscard]] std::optional<Closure> try_closure(std::size_t a, std::size_t b, const Pose2& guess,
                                                   double window_m, double window_rad);
  [[nodiscard]] std::optional<Closure> refine(const registration::MatchField& field, std::size_t a,
                                              std::size_t b, const Pose2& guess) const;
  void add_closure(const Closure& closure);
  /// A measurement between two local maps; lasting: `tighten` does not replace it.
  struct MeasuredEdge {
    pose_graph::Edge edge;
    bool lasting = false;
  };
  [[nodiscard]] std::vector<MeasuredEdge> edges() const;
  static void marginalize(std::vector<MeasuredEdge>& edges, std::size_t node);
  [[nodiscard]] bool is_superfluous(std::size_t index, const KeepConfig& keep) const;
  [[nodiscard]] bool same_frame(std::size_t a, std::size_t b) const {
    return located_[a] == located_[b] && (located_[a] || local_maps_[a].run == local_maps_[b].run);
  }
  void remove(const std::vector<std::size_t>& gone);
  void make_room();
  void measure_breadths();
  void search_closures(std::size_t index);
  void locate_run(std::size_t last);
  std::size_t connect_run(std::size_t first, std::size_t last);
  void optimize();
  void rebuild_graph(const std::vector<Closure>& closures);

  ClosureConfig config_;
  registration::MatchConfig match_;
  registration::MatchFieldConfig field_;
  double resolution_m_;
  WorkerPool& pool_;
  std::vector<LocalMap> local_maps_;
  std::vector<Endpoints> clouds_;
  std::vector<double> breadths_m_;  // of these, when they were added; made again for a saved state
  std::vector<std::optional<Pose2Gaussian>> given_;
  std::vector<bool> located_;
  std::vector<pose_graph::Edge> chain_;  // what `tighten` does not replace
  pose_graph::PoseGraph graph_;
  std::vector<std::pair<std::size_t, std::shared_ptr<const Searchable>>> cache_;
};

}  // namespace strata::slam
