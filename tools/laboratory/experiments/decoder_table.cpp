// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/decoder_table.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <map>

#include "memory/decoding/decode.hpp"
#include "memory/decoding/graph.hpp"

namespace strata::experiments {
namespace {

using memory::DecodedScan;
using memory::NodeLevel;

struct Way {
  std::string name;
  std::function<DecodedScan(const NodeLevel&)> decode;
};

std::vector<Way> ways() {
  const auto by = [](memory::DecodingConfig config) {
    return [config](const NodeLevel& level) { return memory::decode(level, config); };
  };
  return {{"exact", by(memory::exact_decoding())},
          {"scene", by(memory::scene_decoding())},
          {"paper (Dijkstra)", by(memory::paper_decoding())},
          {"literal", by(memory::literal_decoding())},
          {"median of each bin", [](const NodeLevel& level) {
             return DecodedScan{memory::decode_per_bin_median(level), 0.0, false};
           }}};
}

/// Cost in the graph of the path through the range bins that the ranges lie in.
double path_cost(const memory::LayeredGraph& graph, const memory::PolarBins& bins,
                 const std::vector<float>& range_m) {
  std::vector<std::size_t> place;
  for (std::size_t row = 0; row < graph.rows(); ++row) {
    const auto states = graph.states(row);
    const std::uint8_t bin =
        std::isnan(range_m[row]) ? memory::LayeredGraph::kWildcard : bins.range_bin(range_m[row]);
    place.push_back(
        static_cast<std::size_t>(std::find(states.begin(), states.end(), bin) - states.begin()));
  }
  double cost = graph.start_cost()[place[0]];
  for (std::size_t row = 0; row < graph.rows(); ++row) {
    cost += graph.edges_from(row, place[row])[place[graph.next(row)]];
  }
  return cost;
}

/// Adds one level; returns whether it differs.
bool add_level(const NodeLevel& level, const memory::LayeredGraph& graph, const DecodedScan& exact,
               const DecodedScan& other, DecoderRow& row) {
  const memory::PolarBins& bins = level.bins();
  const auto metres = [&](float range_m) {
    return std::min(static_cast<double>(range_m), bins.max_range_m);
  };
  std::size_t different = 0;
  for (std::size_t a = 0; a < exact.range_m.size(); ++a) {
    if (std::isnan(exact.range_m[a])) continue;
    ++row.bins;
    const int apart = std::abs(static_cast<int>(bins.range_bin(exact.range_m[a])) -
                               static_cast<int>(bins.range_bin(other.range_m[a])));
    if (apart == 0) continue;
    ++different;
    row.far_bins += apart > 1 ? 1U : 0U;
    row.apart_m += std::abs(metres(exact.range_m[a]) - metres(other.range_m[a]));
  }
  row.different_bins += different;
  ++row.levels;
  row.inconsistent += other.inconsistent ? 1U : 0U;
  if (different == 0) return false;
  ++row.different_levels;
  const double less = path_cost(graph, bins, other.range_m) - path_cost(graph, bins, exact.range_m);
  if (std::isfinite(less)) {
    row.log_product += less;
    row.worst_log_product = std::max(row.worst_log_product, less);
  } else {
    ++row.impossible;
  }
  return true;
}

double cpu_ms(const std::function<void()>& work) {
  double best = 1e9;
  for (int i = 0; i < 3; ++i) {
    const std::clock_t begin = std::clock();
    work();
    best = std::min(best, 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  return best;
}

}  // namespace

std::vector<DecoderRow> compare_decoders(const memory::TimescaleMemory& memory) {
  std::vector<DecoderRow> rows;
  for (const Way& way : ways()) {
    DecoderRow row;
    row.name = way.name;
    for (const memory::MemoryNode& node : memory.nodes()) {
      bool differs = false;
      for (const NodeLevel& level : node.levels) {
        if (level.sample_count() == 0) continue;
        const memory::LayeredGraph graph = memory::build_graph(level, memory::exact_decoding());
        const DecodedScan exact = memory::decode(level, memory::exact_decoding());
        differs = add_level(level, graph, exact, way.decode(level), row) || differs;
      }
      ++row.nodes;
      row.different_nodes += differs ? 1U : 0U;
    }
    const auto finite = static_cast<double>(row.different_levels - row.impossible);
    if (finite > 0.0) row.log_product /= finite;
    if (row.different_bins > 0) row.apart_m /= static_cast<double>(row.different_bins);
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<StartRow> time_by_starts(const memory::TimescaleMemory& memory) {
  std::map<std::size_t, StartRow> rows;
  for (const memory::MemoryNode& node : memory.nodes()) {
    for (const NodeLevel& level : node.levels) {
      if (level.samples(0).empty()) continue;
      const memory::LayeredGraph paper = memory::build_graph(level, memory::paper_decoding());
      const memory::LayeredGraph exact = memory::build_graph(level, memory::exact_decoding());
      StartRow& row = rows[paper.states(0).size()];
      ++row.levels;
      row.dijkstra_ms += cpu_ms([&] { (void)memory::search_dijkstra(paper); });
      row.exact_ms += cpu_ms([&] { (void)memory::search_layered(exact); });
    }
  }
  std::vector<StartRow> result;
  for (auto& [starts, row] : rows) {
    row.starts = starts;
    row.dijkstra_ms /= static_cast<double>(row.levels);
    row.exact_ms /= static_cast<double>(row.levels);
    result.push_back(row);
  }
  return result;
}

}  // namespace strata::experiments
