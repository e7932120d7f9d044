// SPDX-License-Identifier: Apache-2.0
/// Where the lasers of a chunk of particles are, in columns for kernels.
#pragma once

#include <cstddef>
#include <vector>

#include "core/localization/particle_set.hpp"
#include "core/rays/bundle_kernel.hpp"
#include "core/rays/scan_beams.hpp"

namespace strata::localization {

/// One entry a particle, and the last one again until the vectors are full. Allocates nothing once
/// it has held as many.
class LaserColumns {
 public:
  /// Those of particles [begin, end); at least one.
  void take(const ParticleSet& particles, std::size_t begin, std::size_t end,
            const Pose2& robot_from_laser);
  /// One particle alone.
  void take(const Pose2& map_from_laser);
  /// How many particles.
  [[nodiscard]] std::size_t count() const { return count_; }
  /// Entries of each column.
  [[nodiscard]] std::size_t padded() const { return x_m_.size(); }
  [[nodiscard]] const std::vector<double>& x_m() const { return x_m_; }
  [[nodiscard]] const std::vector<double>& y_m() const { return y_m_; }
  [[nodiscard]] const std::vector<double>& heading_cosine() const { return cosine_; }
  [[nodiscard]] const std::vector<double>& heading_sine() const { return sine_; }

  /// The beams of a scan from all of them, in a table. Valid until the next call.
  [[nodiscard]] rays::BeamBundles bundles(const rays::RayTable& table, const rays::ScanBeams& beams,
                                          double max_range_m);

 private:
  void resize(std::size_t count);
  void set(std::size_t n, const Pose2& laser);

  std::size_t count_ = 0;
  std::vector<double> x_m_, y_m_, cosine_, sine_;
  std::vector<double> column_, row_;
};

}  // namespace strata::localization
