// SPDX-License-Identifier: Apache-2.0
/// Several places where the robot may be, each with particles of its own, until all but one are
/// refuted (docs/theory/patch_localization.md, "Several places").
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/config.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/localization/particle_set.hpp"
#include "core/localization/sensor_model.hpp"

namespace strata::localization {

struct PlaceHypothesesConfig {
  int particles = 60;
  double tempering = 8.0;
  double decided_nats = 8.0;
  double refuted_nats = 16.0;
  double separation_m = 1.0;
  double separation_rad = 0.26;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("particles", c.particles,
            {.doc = "of each place", .unit = "particles", .min = 5, .max = 10000});
    v.field(
        "tempering", c.tempering,
        {.doc = "while there are several places the log-likelihood is divided by this too: scans "
                "from near each other share what is wrong with the map",
         .unit = "1",
         .min = 1.0});
    v.field("decided_nats", c.decided_nats,
            {.doc = "the robot is localized when every other place is at least so much less likely",
             .unit = "nats",
             .min = 0.1});
    v.field("refuted_nats", c.refuted_nats,
            {.doc = "a place that is so much less likely than the likeliest is given up",
             .unit = "nats",
             .min = 0.1});
    v.field("separation_m", c.separation_m,
            {.doc = "nearer places, turned no more than the next, do not refute each other",
             .unit = "m",
             .min = 0.0});
    v.field("separation_rad", c.separation_rad,
            {.doc = "... turned against each other", .unit = "rad", .min = 0.0});
    v.require(c.decided_nats <= c.refuted_nats, "decided_nats", "is above refuted_nats",
              "lower it");
  }
};

/// A place, and how probable it is beside the others.
struct PlaceBelief {
  Pose2 map_from_robot;
  double probability = 0.0;
};

/// Where the particles of a place begin, about a pose.
struct PlaceSeed {
  Pose2 map_from_robot;
  double half_m = 0.35;  ///< half of them anywhere in a square of that half side
  double half_rad = 0.26;
};

/// Which particle belongs to which place. The particles themselves are the filter's: it moves and
/// weighs them all; only resampling keeps to the places, so that none is lost by chance.
class PlaceHypotheses {
 public:
  explicit PlaceHypotheses(const PlaceHypothesesConfig& config) : config_(config) {}

  [[nodiscard]] bool is_active() const { return !places_.empty(); }
  void clear() {
    places_.clear();
    place_of_.clear();
    beliefs_.clear();
    best_ = 0;
  }
  /// Makes the particles those of the seeds, equally likely. With `keeps_old` the particles that
  /// are there make a first place, as likely as all others together.
  void begin(std::span<const PlaceSeed> seeds, bool keeps_old, const PatchStates* states,
             std::uint64_t seed, std::uint64_t step, ParticleSet& particles);
  /// Draws anew within each place where few particles have most of its weight; drops the particles
  /// of places that were given up. spare: the other half of a double buffer.
  void resample(std::uint64_t seed, std::uint64_t step, ParticleSet& particles, ParticleSet& spare);
  /// After the weights: gives up what is refuted, takes together what has met. Whether one place is
  /// left.
  bool judge(const ParticleSet& particles);
  /// The likeliest place, with the covariance of all particles about it.
  [[nodiscard]] Pose2Gaussian leading(const ParticleSet& particles) const;
  /// Keeps `count` particles, of the likeliest place and those that it does not refute; one place
  /// is left.
  void decide(std::size_t count, double offset, ParticleSet& particles, ParticleSet& spare);
  /// Places that are not refuted, the likeliest first.
  [[nodiscard]] const std::vector<PlaceBelief>& beliefs() const { return beliefs_; }

  /// For saved states; the config is the constructor's. Reading fails where a particle has no
  /// place.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    // One by one: as bytes a place has gaps, which are of any value.
    auto count = static_cast<std::uint64_t>(self.places_.size());
    archive(count);
    if constexpr (Archive::kReads) {
      if (count > self.kMaxSavedPlaces) archive.fail("has more places than there can be");
      self.places_.resize(count);
    }
    for (auto& place : self.places_) {
      archive(place.mass);
      archive(place.mean);
      archive(place.is_refuted);
    }
    archive(self.place_of_);
    archive(self.beliefs_);
    archive(self.best_);
    if constexpr (Archive::kReads) {
      if (self.best_ >= std::max<std::size_t>(self.places_.size(), 1)) archive.fail("is damaged");
      for (const std::uint32_t place : self.place_of_) {
        if (place >= count && count > 0) archive.fail("has particles of no place");
      }
    }
  }
  /// Whether two places are one: nearer than `share` of the separation, turned less.
  [[nodiscard]] bool are_near(const Pose2& a, const Pose2& b, double share = 1.0) const;
  /// Of how many particles it knows the place.
  [[nodiscard]] std::size_t particles() const { return place_of_.size(); }

 private:
  static constexpr std::uint64_t kMaxSavedPlaces = 1'000'000;
  struct Place {
    double mass = 0.0;
    Pose2 mean;
    bool is_refuted = false;
  };
  void gather(const ParticleSet& particles);
  void merge();

  PlaceHypothesesConfig config_;
  std::vector<Place> places_;
  std::vector<std::uint32_t> place_of_;  // each particle
  std::vector<PlaceBelief> beliefs_;
  std::size_t best_ = 0;
};

}  // namespace strata::localization
