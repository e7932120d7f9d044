// SPDX-License-Identifier: Apache-2.0
#include "core/patch/patch_learner.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/patch/sequence_vectors.hpp"

namespace strata::patch {
namespace {

constexpr std::size_t kRegionsPerReport = 8;

Grid<std::uint8_t> mask_of(const Region& region, double resolution_m) {
  Grid<std::uint8_t> mask(resolution_m, region.rect, 0);
  for (const Cell& cell : region.cells) mask.at(cell) = 1;
  return mask;
}

bool is_informative(std::span<const float> features, int least) {
  return std::count_if(features.begin(), features.end(), is_known) >= least;
}

/// counts += weight * more.
void add_weighted(Grid<CellCounts>& counts, const Grid<CellCounts>& more, double weight) {
  for (std::size_t i = 0; i < counts.size(); ++i) {
    counts.values()[i].hits += weight * more.values()[i].hits;
    counts.values()[i].misses += weight * more.values()[i].misses;
  }
}

}  // namespace

PatchLearner::PatchLearner(const PatchLearnerConfig& config, int threads)
    : config_(config), pool_(threads) {
  require_valid(config_, "patch_learner");
}

void PatchLearner::add(PosedScan scan) {
  if (!is_finite(scan.map_from_robot)) return;
  scan.static_probability = {};
  scans_.push_back(std::move(scan));
}

Submap PatchLearner::learn_submap(const Region& region, std::span<const Sequence> sequences,
                                  const ReflectionGrid& filtered) const {
  const double resolution = filtered.resolution_m();
  Submap submap;
  submap.rect = region.rect;
  submap.contradictory = mask_of(region, resolution);
  // Counts are made twice instead of kept, so that memory does not grow with the sequences.
  const auto count = [&](const Sequence& sequence) {
    return count_sequence(scans_, sequence, region.rect, resolution, config_.counting);
  };
  VectorSet all{region.cells.size(), {}};
  VectorSet informative{region.cells.size(), {}};
  for (const Sequence& sequence : sequences) {
    const std::vector<float> features = feature_vector(
        filter_counts(count(sequence), config_.prior, config_.min_evidence), region.cells);
    all.values.insert(all.values.end(), features.begin(), features.end());
    if (!is_informative(features, config_.clustering.min_features)) continue;
    informative.values.insert(informative.values.end(), features.begin(), features.end());
  }
  if (informative.size() == 0) return submap;
  const Clustering clustering = select_clusters(informative, config_.clustering);
  const auto memberships =
      memberships_of(all, clustering.clusters.centroids, config_.clustering.fuzzy);
  submap.configurations.resize(clustering.k());
  for (Configuration& c : submap.configurations) {
    c.counts = Grid<CellCounts>(resolution, region.rect);
  }
  for (std::size_t i = 0; i < sequences.size(); ++i) {
    const Grid<CellCounts> counts = count(sequences[i]);
    for (std::size_t k = 0; k < clustering.k(); ++k) {
      add_weighted(submap.configurations[k].counts, counts, memberships[i][k]);
      submap.configurations[k].prior += memberships[i][k] / static_cast<double>(sequences.size());
    }
    const auto& scans = sequences[i].scans;
    const PosedScan& first = scans_[scans.front()];
    const PosedScan& last = scans_[scans.back()];
    submap.sequences.push_back(
        {first.run, first.scan.stamp, last.scan.stamp, scans.size(), memberships[i]});
  }
  for (Configuration& c : submap.configurations) {
    c.reflection = filter_counts(c.counts, config_.prior, config_.min_evidence);
    for (std::size_t i = 0; i < c.reflection.size(); ++i) {
      float& m = c.reflection.values()[i];
      if (!is_known(m)) m = filtered.get(c.reflection.cell(i));
    }
  }
  return submap;
}

PatchMap PatchLearner::finish(const ReflectionGrid& filtered, Progress* progress) {
  const double resolution = filtered.resolution_m();
  PatchMap map;
  map.base = filtered;
  std::vector<Region> regions;
  {
    VisitTable visits = find_visits(scans_, resolution, config_.visits, config_.counting, progress);
    visits.filter(config_.contradiction.prior);
    report_progress(progress, "test contradictions", 0, 1);
    regions = grow_regions(find_contradictions(visits, config_.contradiction), config_.regions);
  }
  regions = config_.regions.places.empty()
                ? merge_regions(std::move(regions), filtered, config_.regions)
                : group_by_places(std::move(regions), resolution, config_.regions);
  std::vector<CellRect> rects;
  for (const Region& region : regions) rects.push_back(region.rect);
  const auto sequences =
      find_sequences(scans_, rects, resolution, config_.sequences, config_.counting, progress);
  std::vector<Submap> submaps(regions.size());
  for (std::size_t begin = 0; begin < regions.size(); begin += kRegionsPerReport) {
    report_progress(progress, "learn configurations", begin, regions.size());
    pool_.for_chunks(std::min(kRegionsPerReport, regions.size() - begin), 1,
                     [&](std::size_t i, std::size_t, std::size_t) {
                       submaps[begin + i] =
                           learn_submap(regions[begin + i], sequences[begin + i], filtered);
                     });
  }
  const std::size_t least = config_.keep_single_configuration ? 1 : 2;
  for (Submap& submap : submaps) {
    if (submap.configurations.size() < least) continue;
    submap.id = static_cast<int>(map.submaps.size());
    map.submaps.push_back(std::move(submap));
  }
  report_progress(progress, "learn configurations", regions.size(), regions.size());
  return map;
}

}  // namespace strata::patch
