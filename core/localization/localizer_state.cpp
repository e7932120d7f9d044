// SPDX-License-Identifier: Apache-2.0
// A localizer as bytes, and one that goes on from them.
#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/base/state_archive.hpp"
#include "core/geometry/matrix_state.hpp"
#include "core/grid/grid_state.hpp"
#include "core/localization/localizer.hpp"
#include "core/scan/scan_state.hpp"

namespace strata::localization {
namespace {

/// 2: with what a model has learned; 3: and whether a place that was found is confirmed;
/// 4: and the last metres beyond the map; 5: and how far it was beyond it; 6: whether the last
/// metres lead instead; 7: and the search beside the pose; 9: and for how long it has contested it.
constexpr std::uint64_t kStateVersion = 9;
/// More than any map asks for; what a damaged state asks for would not fit into memory.
constexpr std::size_t kMaxSavedParticles = std::size_t{1} << 24U;

/// Whether the columns fit each other, and the map, is checked when all is read.
template <class Particles, class Archive>
void archive_particles(Particles& particles, Archive& archive) {
  for (auto* column : {&particles.x_m, &particles.y_m, &particles.theta_rad, &particles.weight}) {
    archive(*column);
  }
  archive(particles.submap);
  archive(particles.configuration);
  archive(particles.beliefs);
  archive(particles.shared_belief);
  archive(particles.time);
}

/// The pooled beliefs are kept: between weighed scans they are not made anew.
template <class Beliefs, class Archive>
void archive_beliefs(Beliefs& beliefs, Archive& archive) {
  auto count = static_cast<std::uint64_t>(beliefs.size());
  archive(count);
  if constexpr (Archive::kReads) {
    if (count > std::uint64_t{1} << 20U) archive.fail("has more sub-maps than there can be");
    beliefs.resize(count);
  }
  for (auto& belief : beliefs) {
    archive(belief.submap);
    archive(belief.mass);
    archive(belief.probability);
  }
}

}  // namespace

template <class Self, class Archive>
void Localizer::state(Self& self, Archive& archive) {
  archive(self.monitor_);
  archive(self.finder_);
  archive(self.places_);
  archive(self.confirmation_);
  archive(self.score_);
  archive(self.odometry_);
  archive(self.beyond_);
  archive(self.turns_);
  archive(self.companions_);
  archive_particles(self.particles_, archive);
  archive_beliefs(self.result_.submaps, archive);
  for (auto* flag :
       {&self.is_seeking_, &self.keeps_old_, &self.is_missing_, &self.is_untold_, &self.is_patched_,
        &self.must_weigh_, &self.are_beliefs_pooled_, &self.is_scattered_}) {
    archive(*flag);
  }
  for (auto* count : {&self.sought_, &self.annealed_updates_}) {
    archive(*count);
    if constexpr (Archive::kReads) {
      if (*count < 0) archive.fail("has counted less than nothing");
    }
  }
  for (auto* count : {&self.start_count_, &self.step_}) archive(*count);
  for (auto* count : {&self.max_particles_, &self.scans_since_weighed_, &self.unusable_scans_,
                      &self.odometry_jumps_}) {
    archive(*count);
  }
  if constexpr (Archive::kReads) {
    if (self.max_particles_ > kMaxSavedParticles) archive.fail("asks for too many particles");
  }
  archive(self.run_);
  archive(self.at_reading_);
  archive(self.last_weighed_);
  archive(self.moved_);
}

void Localizer::write_filter(StateWriter& archive) {
  archive(static_cast<std::uint64_t>(particles_.belief_columns));
  state(*this, archive);
}

void Localizer::read_filter(StateReader& archive) {
  std::uint64_t columns = 0;
  archive(columns);
  state(*this, archive);
  particles_.belief_columns = columns;
  if (!fits_map()) archive.refuse("is of other maps");
  const PatchStates* states = model_->patch_states();
  if (states != nullptr && particles_.time) states->tell_time(*particles_.time, particles_);
  resampled_ = particles_;
}

std::optional<std::vector<std::uint8_t>> Localizer::saved_state(std::size_t max_learned_bytes) {
  if (!is_started_) return std::nullopt;
  std::optional<std::vector<std::uint8_t>> learned;
  if (own_model_ != nullptr) {
    learned = own_model_->save_learned(max_learned_bytes);
    if (!learned) return std::nullopt;
  }
  StateWriter archive;
  archive(kStateVersion);
  archive(learned);
  write_filter(archive);
  archive(watch_);
  archive(contested_scans_);
  archive(scout_ != nullptr);
  if (scout_ != nullptr) {
    archive(scout_->seed_);
    scout_->write_filter(archive);
  }
  return archive.take();
}

/// Whether every index and every row is one of this map's.
bool Localizer::fits_map() const {
  const ParticleSet& all = particles_;
  const std::size_t count = all.size();
  for (const auto* column : {&all.y_m, &all.theta_rad, &all.weight}) {
    if (column->size() != count) return false;
  }
  if (count == 0 || all.submap.size() != count || all.configuration.size() != count) return false;
  if (places_.is_active() && places_.particles() != count) return false;
  const PatchStates* states = model_->patch_states();
  ParticleSet expected;
  expected.resize(1);
  if (states != nullptr) states->prepare(expected);
  if (all.belief_columns != expected.belief_columns ||
      all.beliefs.size() != count * expected.belief_columns ||
      all.shared_belief.size() != expected.shared_belief.size()) {
    return false;
  }
  const auto submaps = states != nullptr ? static_cast<int>(states->map().submaps.size()) : 0;
  for (std::size_t i = 0; i < count; ++i) {
    const int submap = all.submap[i];
    if (submap < -1 || submap >= submaps || all.configuration[i] < -1) return false;
    const int configurations = submap < 0 ? 0 : states->count(static_cast<std::size_t>(submap));
    if (all.configuration[i] >= configurations) return false;
  }
  return std::all_of(result_.submaps.begin(), result_.submaps.end(), [&](const auto& belief) {
    return belief.submap >= 0 && belief.submap < submaps &&
           static_cast<int>(belief.probability.size()) ==
               states->count(static_cast<std::size_t>(belief.submap));
  });
}

void Localizer::restore(std::span<const std::uint8_t> bytes, const std::string& place) {
  is_started_ = false;
  StateReader archive(bytes, place);
  archive.expect_version(kStateVersion);
  std::optional<std::vector<std::uint8_t>> learned;
  archive(learned);
  if (learned.has_value() != (own_model_ != nullptr)) {
    archive.refuse(learned ? "is of a model that goes on learning"
                           : "is of a model that does not learn");
  }
  read_filter(archive);
  archive(watch_);
  archive(contested_scans_);
  if (contested_scans_ < 0) archive.fail("has counted less than nothing");
  bool has_scout = false;
  archive(has_scout);
  scout_.reset();
  if (has_scout) {
    std::uint64_t seed = 0;
    archive(seed);
    scout_.reset(new Localizer(*this, seed));
    scout_->read_filter(archive);
    scout_->is_started_ = true;
  }
  if (is_contested() && !has_scout) archive.fail("is contested by nobody");
  archive.expect_end();
  if (learned) own_model_->restore_learned(*learned, place);
  is_started_ = true;
}

}  // namespace strata::localization
