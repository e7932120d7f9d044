// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/cluster_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/base/error.hpp"
#include "core/patch/sequence_vectors.hpp"
#include "core/patch/sequences.hpp"

namespace strata::experiments {
namespace {

std::size_t likeliest(const std::vector<double>& membership) {
  const auto best = std::max_element(membership.begin(), membership.end());
  return static_cast<std::size_t>(best - membership.begin());
}

/// The scans that the learner took for this sequence.
patch::Sequence scans_of(const patch::SequenceInfo& info, const std::vector<PosedScan>& scans,
                         const CellRect& rect, const patch::PatchLearnerConfig& config,
                         double resolution_m) {
  patch::SequenceMembership membership(config.sequences, config.counting, resolution_m);
  patch::Sequence sequence;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const PosedScan& scan = scans[i];
    if (scan.run != info.run || scan.scan.stamp < info.begin || info.end < scan.scan.stamp) {
      continue;
    }
    membership.set_scan(scan);
    if (membership.belongs_to(rect)) sequence.scans.push_back(static_cast<std::uint32_t>(i));
  }
  if (sequence.scans.size() != info.scans) {
    throw Error("cluster_rows", "finds other scans than the learner did", "report this");
  }
  return sequence;
}

/// What each sequence shows, as the learner reads it.
void add_local_maps(const simulate::Simulation& simulation, const std::vector<PosedScan>& scans,
                    const simulate::ChangeableObject& object, ClusterRows& rows) {
  const patch::PatchLearnerConfig config;
  const double resolution_m = rows.base.resolution_m();
  rows.local_maps.dimension = rows.cells.size();
  for (const patch::SequenceInfo& info : rows.submap.sequences) {
    const patch::Sequence sequence = scans_of(info, scans, rows.submap.rect, config, resolution_m);
    const auto counts =
        patch::count_sequence(scans, sequence, rows.submap.rect, resolution_m, config.counting);
    const std::vector<float> features = patch::feature_vector(
        patch::filter_counts(counts, config.prior, config.min_evidence), rows.cells);
    if (std::count_if(features.begin(), features.end(), is_known) <
        config.clustering.min_features) {
      continue;
    }
    rows.local_maps.values.insert(rows.local_maps.values.end(), features.begin(), features.end());
    rows.states.push_back(state_during(simulation, object, info));
  }
}

double distance(const patch::Centroid& a, const patch::Centroid& b) {
  double squared = 0.0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    const double difference = a[j] - b[j];
    if (!std::isnan(difference)) squared += difference * difference;
  }
  return std::sqrt(squared);
}

}  // namespace

std::size_t ClusterRows::best() const {
  return static_cast<std::size_t>(std::max_element(criterion.begin(), criterion.end()) -
                                  criterion.begin());
}

std::size_t ClusterRows::rightly_clustered() const {
  const auto& memberships = rows[best()].memberships;
  std::vector<std::map<std::size_t, std::size_t>> states_in(rows[best()].centroids.size());
  for (std::size_t i = 0; i < states.size(); ++i) ++states_in[likeliest(memberships[i])][states[i]];
  // The cluster of a state is the one that has most of it; of two states that share one, the
  // greater is right.
  std::map<std::size_t, std::size_t> right;
  for (const auto& in_cluster : states_in) {
    const auto most =
        std::max_element(in_cluster.begin(), in_cluster.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most == in_cluster.end()) continue;
    right[most->first] = std::max(right[most->first], most->second);
  }
  std::size_t sum = 0;
  for (const auto& [state, count] : right) sum += count;
  return sum;
}

bool ClusterRows::splits_a_state() const {
  if (best() + 1 >= rows.size()) return false;
  const patch::FuzzyClusters& next = rows[best() + 1];
  const std::size_t newest = next.centroids.size() - 1;
  std::set<std::size_t> in_newest;
  std::set<std::size_t> in_others;
  for (std::size_t i = 0; i < states.size(); ++i) {
    (likeliest(next.memberships[i]) == newest ? in_newest : in_others).insert(states[i]);
  }
  return in_newest.size() == 1 && in_others.count(*in_newest.begin()) == 1;
}

double ClusterRows::mean_membership() const {
  double sum = 0.0;
  for (const std::vector<double>& row : rows[best()].memberships) {
    sum += *std::max_element(row.begin(), row.end()) / static_cast<double>(states.size());
  }
  return sum;
}

double ClusterRows::nearest_centres(std::size_t row) const {
  double nearest = std::numeric_limits<double>::infinity();
  const std::vector<patch::Centroid>& centres = rows[row].centroids;
  for (std::size_t b = 1; b < centres.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      nearest = std::min(nearest, distance(centres[a], centres[b]));
    }
  }
  return nearest;
}

std::optional<ClusterRows> cluster_rows(const std::string& scenario, std::uint64_t seed) {
  const simulate::Simulation simulation =
      simulate::simulate(simulate::load_scenario(scenario), seed);
  const std::vector<PosedScan> scans =
      noisy_scans(simulation, kGoodPoses, seed, 1, static_cast<int>(simulation.days.size()));
  const patch::PatchMap map = learn_patches(scans, static_maps(scans).filtered);
  for (const patch::Submap& submap : map.submaps) {
    const auto objects = covered_objects(simulation, submap, map.base.resolution_m());
    if (objects.size() != 1) continue;
    ClusterRows rows;
    rows.base = map.base;
    rows.submap = submap;
    for (std::size_t i = 0; i < submap.contradictory.size(); ++i) {
      if (submap.contradictory.values()[i] == 0) continue;
      rows.cells.push_back(submap.contradictory.cell(i));
    }
    add_local_maps(simulation, scans, *objects.front(), rows);
    const patch::Clustering clustering =
        patch::select_clusters(rows.local_maps, patch::ModelSelectionConfig{},
                               [&](const patch::FuzzyClusters& row) { rows.rows.push_back(row); });
    rows.criterion = clustering.criterion;
    return rows;
  }
  return std::nullopt;
}

ReflectionGrid over_base(const ClusterRows& rows, std::span<const double> entries) {
  ReflectionGrid grid = rows.base.cropped(rows.submap.rect);
  for (std::size_t j = 0; j < entries.size(); ++j) {
    grid.at(rows.cells[j]) = static_cast<float>(entries[j]);
  }
  return grid;
}

}  // namespace strata::experiments
