// SPDX-License-Identifier: Apache-2.0
#include "core/patch/configurations.hpp"

#include <algorithm>
#include <utility>

#include "core/patch/chain.hpp"
#include "core/patch/chain_in_time.hpp"
#include "core/patch/recurrence.hpp"
#include "core/patch/sequence_vectors.hpp"

namespace strata::patch {
namespace {

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

/// The clusters in the order of the first sequence that each is likeliest for, so that what was a
/// configuration's place stays its place while sequences are added.
std::vector<std::size_t> order_of_appearance(const std::vector<std::vector<double>>& memberships) {
  std::vector<std::size_t> order;
  for (const std::vector<double>& row : memberships) {
    const auto c = static_cast<std::size_t>(std::max_element(row.begin(), row.end()) - row.begin());
    if (std::find(order.begin(), order.end(), c) == order.end()) order.push_back(c);
  }
  for (std::size_t c = 0; c < memberships[0].size(); ++c) {
    if (std::find(order.begin(), order.end(), c) == order.end()) order.push_back(c);
  }
  return order;
}

std::vector<std::vector<double>> in_order(std::vector<std::vector<double>> rows,
                                          const std::vector<std::size_t>& order) {
  for (std::vector<double>& row : rows) {
    const std::vector<double> before = row;
    for (std::size_t k = 0; k < order.size(); ++k) row[k] = before[order[k]];
  }
  return rows;
}

}  // namespace

Submap learn_configurations(const Region& region, std::span<const SequenceInfo> infos,
                            const SequenceHistory& history,
                            const std::function<Grid<CellCounts>(std::size_t)>& counts_of,
                            const ReflectionGrid& filtered, const PatchLearnerConfig& config) {
  const double resolution = filtered.resolution_m();
  Submap submap;
  submap.rect = region.rect;
  submap.contradictory = mask_of(region, resolution);
  VectorSet all{region.cells.size(), {}};
  VectorSet informative{region.cells.size(), {}};
  for (std::size_t i = 0; i < infos.size(); ++i) {
    const std::vector<float> features = feature_vector(
        filter_counts(counts_of(i), config.prior, config.min_evidence), region.cells);
    all.values.insert(all.values.end(), features.begin(), features.end());
    if (!is_informative(features, config.clustering.min_features)) continue;
    informative.values.insert(informative.values.end(), features.begin(), features.end());
  }
  if (informative.size() == 0) return submap;
  const Clustering clustering = select_clusters(informative, config.clustering);
  const std::vector<Centroid>& centroids = clustering.clusters.centroids;
  const auto found = memberships_of(all, centroids, config.clustering.fuzzy);
  const std::vector<std::size_t> order = order_of_appearance(found);
  const auto memberships = in_order(found, order);
  submap.configurations.resize(clustering.k());
  for (Configuration& c : submap.configurations) {
    c.counts = Grid<CellCounts>(resolution, region.rect);
  }
  for (std::size_t i = 0; i < infos.size(); ++i) {
    const Grid<CellCounts> counts = counts_of(i);
    for (std::size_t k = 0; k < clustering.k(); ++k) {
      add_weighted(submap.configurations[k].counts, counts, memberships[i][k]);
    }
    submap.sequences.push_back(infos[i]);
    submap.sequences.back().membership = memberships[i];
  }
  const auto looks =
      in_order(likelihood_shares(all, centroids, config.clustering.cell_stddev), order);
  submap.recurrence = recurrence_of(looks, history);
  const Chain chain = learn_chain(looks, history, config.chain);
  // By the memberships, which messages carry: who gets the map by one finds the same bits.
  submap.change_rate_per_s = learn_rate_per_s(memberships, history, chain.usual, config.chain);
  for (std::size_t k = 0; k < clustering.k(); ++k) submap.configurations[k].prior = chain.usual[k];
  follow_time(memberships, history, config.chain, submap);
  for (Configuration& c : submap.configurations) {
    c.reflection = filter_counts(c.counts, config.prior, config.min_evidence);
    for (std::size_t i = 0; i < c.reflection.size(); ++i) {
      float& m = c.reflection.values()[i];
      if (!is_known(m)) m = filtered.get(c.reflection.cell(i));
    }
  }
  return submap;
}

void keep_changing(std::vector<Submap> submaps, const PatchLearnerConfig& config, PatchMap& map) {
  const std::size_t least = config.keep_single_configuration ? 1 : 2;
  std::vector<Recurrence> recurrences;
  for (const Submap& submap : submaps) recurrences.push_back(submap.recurrence);
  const std::vector<double> probabilities = return_probabilities(recurrences);
  for (std::size_t i = 0; i < submaps.size(); ++i) {
    Submap& submap = submaps[i];
    if (submap.configurations.size() < least) continue;
    if (probabilities[i] < config.recurrence.min_probability) {
      map.unrecurring.push_back(submap.rect);
      continue;
    }
    submap.id = static_cast<int>(map.submaps.size());
    map.submaps.push_back(std::move(submap));
  }
}

}  // namespace strata::patch
