// SPDX-License-Identifier: Apache-2.0
/// Sub-maps of all runs, tied together by what they see of each other.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/base/progress.hpp"
#include "core/pose_graph/pose_graph.hpp"
#include "core/slam/keep_config.hpp"
#include "core/slam/slam_config.hpp"
#include "core/slam/submap.hpp"
#include "core/slam/submap_agreement.hpp"

namespace strata::slam {

/// Pose graph over sub-maps. A new sub-map is tied to its predecessor in the run; then it is
/// looked for in older sub-maps: those it may overlap given how far the path between them can have
/// drifted, by correlative search, refined by matching, and accepted when the space both have
/// seen agrees both ways. The pull of a closure fades when the others contradict it (robust
/// kernel), and it is dropped when it stays contradicted.
class SubmapGraph {
 public:
  SubmapGraph(const ClosureConfig& config, const registration::MatchConfig& match,
              const registration::MatchFieldConfig& field, double resolution_m, WorkerPool& pool);
  ~SubmapGraph();

  /// Adds the next sub-map of its run; runs must not interleave. given_map_from_submap: where given
  /// poses put it, with that uncertainty. Returns its index.
  std::size_t add(Submap submap, const std::optional<Pose2Gaussian>& given_map_from_submap);

  /// Tells that the run is complete: one that is not located yet is searched for as a whole.
  void end_run();

  /// Takes out the sub-maps of scans before that one which later ones have made superfluous
  /// (KeepConfig); what they said of those that stay is passed on. Returns their indices,
  /// ascending; those above move down. O(cells / 211 x sub-maps) for each sub-map that may overlap
  /// the newest one.
  std::vector<std::size_t> forget(const KeepConfig& keep, std::size_t before_scan);

  /// Lays every pair of overlapping sub-maps on each other anew from the present poses, replaces
  /// all closures by the outcome, and optimizes [lu1997globally]; `rounds` times.
  void tighten(int rounds, Progress* progress);

  [[nodiscard]] std::size_t size() const { return submaps_.size(); }
  [[nodiscard]] const Submap& submap(std::size_t index) const { return submaps_[index]; }
  [[nodiscard]] const Pose2& map_from_submap(std::size_t index) const { return graph_.pose(index); }
  /// Takes the run's drifting frame to the map as the sub-map has it.
  [[nodiscard]] Pose2 map_from_run(std::size_t index) const {
    return graph_.pose(index) * inverse(submaps_[index].run_from_submap);
  }
  [[nodiscard]] std::size_t closures() const;
  /// Whether the sub-map is tied to the first run (or to given poses).
  [[nodiscard]] bool located(std::size_t index) const { return located_[index]; }

  /// For saved states; everything but what can be made again is the constructor's.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.submaps_);
    archive(self.clouds_);
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
  [[nodiscard]] std::optional<Closure> try_closure(std::size_t a, std::size_t b, const Pose2& guess,
                                                   double window_m, double window_rad);
  [[nodiscard]] std::optional<Closure> refine(const registration::MatchField& field, std::size_t a,
                                              std::size_t b, const Pose2& guess) const;
  void add_closure(const Closure& closure);
  /// A measurement between two sub-maps; lasting: `tighten` does not replace it.
  struct Tie {
    pose_graph::Edge edge;
    bool lasting = false;
  };
  [[nodiscard]] std::vector<Tie> ties() const;
  static void bridge(std::vector<Tie>& ties, std::size_t node);
  [[nodiscard]] bool is_superfluous(std::size_t index, const KeepConfig& keep) const;
  [[nodiscard]] bool same_frame(std::size_t a, std::size_t b) const {
    return located_[a] == located_[b] && (located_[a] || submaps_[a].run == submaps_[b].run);
  }
  void remove(const std::vector<std::size_t>& gone);
  void search_closures(std::size_t index);
  void locate_run(std::size_t last);
  std::size_t tie_run(std::size_t first, std::size_t last);
  void optimize();
  void rebuild_graph(const std::vector<Closure>& closures);

  ClosureConfig config_;
  registration::MatchConfig match_;
  registration::MatchFieldConfig field_;
  double resolution_m_;
  WorkerPool& pool_;
  std::vector<Submap> submaps_;
  std::vector<Endpoints> clouds_;
  std::vector<std::optional<Pose2Gaussian>> given_;
  std::vector<bool> located_;
  std::vector<pose_graph::Edge> chain_;  // what `tighten` does not replace
  pose_graph::PoseGraph graph_;
  std::vector<std::pair<std::size_t, std::shared_ptr<const Searchable>>> cache_;
};

}  // namespace strata::slam
