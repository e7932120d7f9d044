// SPDX-License-Identifier: Apache-2.0
/// How the decoders of [kessler2010what] differ on what a memory really holds, and table 1 on it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "memory/nodes/timescale_memory.hpp"

namespace strata::experiments {

/// One decoder against the exact one, over every level of every node that has samples.
struct DecoderRow {
  std::string name;
  std::size_t levels = 0;
  std::size_t different_levels = 0;  ///< at least one angle bin shows another range bin
  std::size_t nodes = 0;
  std::size_t different_nodes = 0;  ///< one of its levels does
  std::size_t bins = 0;             ///< angle bins with samples
  std::size_t different_bins = 0;
  std::size_t far_bins = 0;  ///< ... by more than one range bin
  double apart_m = 0.0;      ///< mean over the different bins, at most max_range_m each
  double log_product =
      0.0;  ///< nats that a different level's path is less likely, mean, where finite
  double worst_log_product = 0.0;
  std::size_t impossible = 0;    ///< levels whose path has a pair of probability 0
  std::size_t inconsistent = 0;  ///< levels without a closed path
};

/// Rows for exact itself, scene, the paper's costs by Dijkstra, its equation (4) as printed, and
/// the median of each bin. The probability of a path is that of the exact decoder's graph: prior
/// and tolerant pair statistics.
[[nodiscard]] std::vector<DecoderRow> compare_decoders(const memory::TimescaleMemory& memory);

/// Table 1: levels by the number of start bins of their first angle bin.
struct StartRow {
  std::size_t starts = 0;
  std::size_t levels = 0;
  double dijkstra_ms = 0.0;  ///< mean CPU time, the paper's costs, all starts together
  double exact_ms = 0.0;     ///< of the exact decoder's search
};
[[nodiscard]] std::vector<StartRow> time_by_starts(const memory::TimescaleMemory& memory);

}  // namespace strata::experiments
