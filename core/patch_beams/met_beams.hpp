// SPDX-License-Identifier: Apache-2.0
/// The beams of a chunk that met changing cells in their way, in lists by how they are mixed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/patch_beams/changing_beams.hpp"
#include "core/patch_beams/chunk.hpp"
#include "core/patch_beams/submap_ratios.hpp"

namespace strata::patch_beams {

/// Beams that end at one of two places: at an obstacle that is there in some configurations of one
/// sub-map, or behind it. Columns of one entry a beam.
struct PairBeams {
  struct Beam {
    std::size_t log = 0;     ///< its place in the rows of beams
    std::uint64_t near = 0;  ///< configurations that end it at the nearer place
    std::size_t row = 0;     ///< of its sub-map's configurations in SubmapRatios
    std::uint32_t particle = 0;
    std::uint32_t configurations = 0;  ///< how many; 0 without memory
  };
  std::vector<Beam> beams;
  std::vector<double> share;              ///< probability that the nearer obstacle is there
  std::vector<double> near_log, far_log;  ///< what the beam says at either place
};

/// Beams that may end at more.
struct SeveralBeams {
  struct Beam {
    std::size_t log = 0;  ///< its place in the rows of beams
    std::size_t particle = 0;
    std::size_t event = 0;  ///< first of its places in `events`
    std::size_t value = 0;  ///< ... in `likelihood`
    std::size_t count = 0;  ///< of its events
    std::size_t met = 0;    ///< first of its places in `met`
    std::size_t met_end = 0;
    bool is_once_each = false;  ///< it met no sub-map twice, and few enough
  };
  /// A sub-map that such a beam met.
  struct Met {
    std::int32_t submap = -1;
    std::size_t row = 0;  ///< of its configurations in SubmapRatios
  };
  static constexpr std::size_t kMaxOnce = 8;  ///< events of a beam with is_once_each
  std::vector<Beam> beams;
  std::vector<RayEvent> events;    ///< of each beam in order of range
  std::vector<double> likelihood;  ///< of the events of a beam, then of its end
  std::vector<Met> met;            ///< with memory: by each of them
};

struct MetBeams {
  PairBeams pairs;
  SeveralBeams several;
};

/// Lists the beams that met something, but for ChangingBeams::single(), and what each says where.
/// log_likelihood: rows of beams, of where they end for certain. `ratios` is begun anew: with
/// memory it gets rows of 0 for the sub-maps that these beams met.
void list_met_beams(const PatchChunk& chunk, const ChangingBeams& changing,
                    std::span<const double> log_likelihood, MetBeams& met, SubmapRatios& ratios);

}  // namespace strata::patch_beams
