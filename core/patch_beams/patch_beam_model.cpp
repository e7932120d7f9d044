// SPDX-License-Identifier: Apache-2.0
#include "core/patch_beams/patch_beam_model.hpp"

#include <functional>
#include <limits>
#include <vector>

#include "core/localization/laser_columns.hpp"
#include "core/localization/object_pool.hpp"
#include "core/localization/unjudged_beams.hpp"
#include "core/patch_beams/beam_ends.hpp"
#include "core/patch_beams/beam_mixing.hpp"
#include "core/patch_beams/belief_learning.hpp"
#include "core/patch_beams/chunk.hpp"
#include "core/patch_beams/met_beams.hpp"
#include "core/patch_beams/patch_explanation.hpp"
#include "core/patch_beams/something_else.hpp"
#include "core/patch_beams/submap_ratios.hpp"
#include "core/rays/column_math.hpp"

namespace strata::patch_beams {
namespace {

using localization::ObjectPool;
using localization::ParticleSet;
using localization::PatchMemory;
using localization::PatchStates;
using localization::SubmapBelief;

// Twice as many as without sub-maps: what is found once a chunk costs more here.
constexpr std::size_t kChunk = 128;

/// What the stages of one chunk hand on, each in memory that is kept between chunks.
struct ChunkMemory {
  localization::LaserColumns lasers;
  StaticEnds still;
  ChangingEnds changing;
  MetBeams met;
  SingleMixing single;
  std::vector<double> mixed;
  std::vector<double> sums;
  BeliefColumns beliefs;
};

/// Weighs particles [begin, end), but for what learn_beliefs() adds; log_likelihood: of all.
/// docs/theory/patch_beams.md, "Pipeline".
void weigh_chunk(const PreparedScan& scan, double tempering, const PatchRayCaster& caster,
                 const PatchStates& layout, ParticleSet& particles, std::size_t begin,
                 std::size_t end, bool expects_something_else, std::span<double> log_likelihood,
                 ChunkMemory& memory, SubmapRatios& ratios) {
  memory.lasers.take(particles, begin, end, scan.beams.robot_from_laser);
  const PatchChunk chunk{caster,
                         layout,
                         chunk_states(layout, particles, begin, end),
                         belief_rows(layout, particles, begin),
                         memory.lasers.padded(),
                         expects_something_else};
  cast_static(scan, caster, memory.lasers, memory.still);
  find_changing(scan, caster, chunk.states, memory.still.range_m.data(), memory.lasers,
                memory.changing);
  const std::span<double> logs = memory.still.log_likelihood;
  list_met_beams(chunk, memory.changing.beams, logs, memory.met, ratios);
  mix_single(chunk, scan.mixture, memory.changing.boxes, memory.changing.beams.single(), logs,
             ratios, memory.single);
  mix_pairs(memory.met.pairs, logs, ratios, memory.mixed);
  mix_several(chunk, memory.met.several, logs, ratios, memory.mixed);
  memory.sums.resize(chunk.bundles);
  rays::sum_rows(logs.data(), scan.beams.size(), chunk.bundles, memory.sums.data());
  const std::span<double> weighed = log_likelihood.subspan(begin, end - begin);
  for (std::size_t n = 0; n < weighed.size(); ++n) {
    weighed[n] = (memory.sums[n] + memory.single.log_likelihood[n]) / tempering;
  }
}

/// What is believed of all sub-maps, as one row.
struct Posterior {
  std::vector<SubmapBelief> submaps;
  std::vector<float> row;

  void take(const std::vector<SubmapBelief>& pooled) {
    row.clear();
    for (const SubmapBelief& submap : pooled) {
      for (const double p : submap.probability) row.push_back(static_cast<float>(p));
    }
  }
};

void prepare(const Scan& scan, const rays::BeamSelectionConfig& config,
             const rays::BeamMixture& mixture, PreparedScan& prepared) {
  rays::select_beams(scan, config, prepared.beams);
  prepared.mixture.prepare(mixture.limited_to(prepared.beams.r_max_m), prepared.beams);
}

}  // namespace

struct PatchBeamModel::Lenders {
  ObjectPool<PreparedScan> scans;
  ObjectPool<ChunkMemory> chunks;
  ObjectPool<std::vector<SubmapRatios>> ratios;  // of each chunk
  ObjectPool<SomethingElse> something_else;
  ObjectPool<ExplanationMemory> explanations;
  ObjectPool<Posterior> posteriors;
  ObjectPool<std::vector<RayEvent>> events;
};

PatchBeamModel::PatchBeamModel(std::shared_ptr<const patch::PatchMap> map,
                               const PatchBeamModelConfig& config)
    : config_(config),
      states_(map, config.states),
      caster_(*map),
      mixture_(config.beam.mixture, 1.0),
      lenders_(std::make_unique<const Lenders>()) {
  require_valid(config, "patch_beam_model");
}

PatchBeamModel::~PatchBeamModel() = default;

std::size_t PatchBeamModel::log_likelihoods(const Scan& scan,
                                            const localization::Weighing& weighing,
                                            ParticleSet& particles,
                                            std::span<double> log_likelihood,
                                            WorkerPool& pool) const {
  const auto prepared = lenders_->scans.acquire();
  prepare(scan, config_.beam.beams, mixture_, *prepared);
  const auto ratios = lenders_->ratios.acquire();
  const std::size_t chunks = (particles.size() + kChunk - 1) / kChunk;
  if (ratios->size() < chunks) ratios->resize(chunks);
  const bool has_memory = states_.memory() != PatchMemory::kNone;
  const bool learns_later = states_.expects_something_else() && weighing.is_place_sure;
  const auto learn = [&](std::size_t begin, std::size_t end, std::size_t chunk) {
    const auto memory = lenders_->chunks.acquire();
    learn_beliefs(states_, weighing.tempering, begin, log_likelihood.subspan(begin, end - begin),
                  (*ratios)[chunk], particles, memory->beliefs);
  };
  const auto weigh = [&](std::size_t begin, std::size_t end, std::size_t chunk) {
    {
      const auto memory = lenders_->chunks.acquire();
      weigh_chunk(*prepared, weighing.tempering, caster_, states_, particles, begin, end,
                  learns_later, log_likelihood, *memory, (*ratios)[chunk]);
    }
    if (has_memory && !learns_later) learn(begin, end, chunk);
  };
  pool.for_chunks(particles.size(), kChunk, std::cref(weigh));
  if (!learns_later) return prepared->beams.size();
  const auto something_else = lenders_->something_else.acquire();
  something_else->explain(states_, weighing.tempering, particles.weight, log_likelihood, kChunk,
                          std::span(*ratios).first(chunks));
  pool.for_chunks(particles.size(), kChunk, std::cref(learn));
  return prepared->beams.size();
}

localization::InlierShares PatchBeamModel::inlier_shares(const Scan& scan,
                                                         const Pose2& map_from_robot,
                                                         const ParticleSet& particles) const {
  const auto pooled = lenders_->posteriors.acquire();
  states_.posterior(particles, pooled->submaps);
  return inlier_shares_given(pooled->submaps, scan, map_from_robot, particles);
}

localization::InlierShares PatchBeamModel::inlier_shares_given(
    const std::vector<SubmapBelief>& posterior, const Scan& scan, const Pose2& map_from_robot,
    const ParticleSet& /*particles*/) const {
  const auto prepared = lenders_->scans.acquire();
  prepare(scan, config_.beam.beams, mixture_, *prepared);
  const auto believed = lenders_->posteriors.acquire();
  believed->take(posterior);
  const auto memory = lenders_->explanations.acquire();
  return explain_beams(*prepared, caster_, states_,
                       map_from_robot * prepared->beams.robot_from_laser,
                       states_.submap_of(map_from_robot.translation()), believed->row, *memory);
}

void PatchBeamModel::find_unjudged(const Scan& scan, const Pose2& map_from_robot,
                                   std::vector<std::uint8_t>& is_unjudged) const {
  const Pose2 laser = map_from_robot * scan.robot_from_laser;
  const auto events = lenders_->events.acquire();
  const auto expected_m = [&](std::size_t /*beam*/, const Eigen::Vector2d& direction,
                              double limit_m) {
    caster_.events(laser.x, laser.y, direction.x(), direction.y(), limit_m, -1, *events);
    return events->empty() ? std::numeric_limits<double>::infinity() : events->front().range_m;
  };
  localization::mark_unjudged(caster_, scan, laser, mixture_.tolerance_m(), expected_m,
                              is_unjudged);
}

}  // namespace strata::patch_beams
