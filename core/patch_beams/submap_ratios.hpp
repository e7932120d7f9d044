// SPDX-License-Identifier: Apache-2.0
/// What a scan says of the configurations of sub-maps, for each particle of a chunk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace strata::patch_beams {

/// Rows of one entry a particle, one row for each configuration of each sub-map that any beam of
/// the chunk met; the rest take no room. Allocates nothing once warm.
class SubmapRatios {
 public:
  struct Met {
    std::size_t submap = 0;
    std::size_t configurations = 0;  ///< its rows, that of something else included
    std::size_t row = 0;             ///< of its first configuration
  };

  /// Forgets all. submaps: how many there are; particles: in the chunk.
  void begin(std::size_t submaps, std::size_t particles) {
    for (const Met& met : met_) place_of_[met.submap] = -1;
    place_of_.resize(submaps, -1);
    met_.clear();
    values_.clear();
    is_met_.clear();
    particles_ = particles;
  }
  /// A beam of the particle met a sub-map: the first row of its configurations, all 0 at first.
  std::size_t meet(std::size_t submap, std::size_t configurations, std::size_t particle) {
    const std::size_t place = place_of(submap, configurations);
    is_met_[place * particles_ + particle] = 1;
    return met_[place].row;
  }
  /// The same for a sub-map that has a place already.
  void meet_again(std::size_t place, std::size_t particle) {
    is_met_[place * particles_ + particle] = 1;
  }
  /// Number of a sub-map in met(), which it is added to.
  std::size_t place_of(std::size_t submap, std::size_t configurations) {
    std::int32_t& place = place_of_[submap];
    if (place < 0) {
      place = static_cast<std::int32_t>(met_.size());
      met_.push_back({submap, configurations, particles_ > 0 ? values_.size() / particles_ : 0});
      values_.resize(values_.size() + configurations * particles_, 0.0);
      is_met_.resize(is_met_.size() + particles_, 0);
    }
    return static_cast<std::size_t>(place);
  }
  /// Null where no beam met it.
  [[nodiscard]] const Met* find(std::size_t submap) const {
    const std::int32_t place = place_of_[submap];
    return place < 0 ? nullptr : &met_[static_cast<std::size_t>(place)];
  }
  /// In the order in which beams met them.
  [[nodiscard]] const std::vector<Met>& met() const { return met_; }
  /// Whether a beam of the particle met number `place` of met().
  [[nodiscard]] bool is_met(std::size_t place, std::size_t particle) const {
    return is_met_[place * particles_ + particle] != 0;
  }
  [[nodiscard]] double& at(std::size_t row, std::size_t particle) {
    return values_[row * particles_ + particle];
  }
  /// All rows.
  [[nodiscard]] std::vector<double>& values() { return values_; }

 private:
  std::size_t particles_ = 0;
  std::vector<std::int32_t> place_of_;  // of each sub-map in met_; -1: no beam met it
  std::vector<Met> met_;
  std::vector<double> values_;
  std::vector<unsigned char> is_met_;
};

}  // namespace strata::patch_beams
