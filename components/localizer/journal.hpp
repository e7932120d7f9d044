// SPDX-License-Identifier: Apache-2.0
/// What a localizer tells while somebody records it, so that its run can be gone through again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "components/bus/endpoint.hpp"
#include "components/localizer/restore_point.hpp"
#include "core/localization/localizer.hpp"
#include "core/scan/scan.hpp"

namespace strata::localizer {

/// Every scan as the filter was given it, with the pose that came out (strata_msgs/LabeledScan, as
/// bits), and now and then the filter itself. Without readers nothing is made. Not thread safe.
class Journal {
 public:
  struct Limits {
    Duration period;                    ///< between two restore points, by stamps
    std::size_t max_learned_bytes = 0;  ///< of what a model has learned, in each of them
  };
  /// make_point: a restore point but for scan and state.
  Journal(std::shared_ptr<bus::RawWriter> scans, std::shared_ptr<bus::RawWriter> points,
          std::function<RestorePoint()> make_point, const Limits& limits);

  /// Something else than a scan has changed the filter: the next scan begins anew.
  void interrupt() { is_interrupted_ = true; }
  /// Before the scan is worked on. O(particles + what was learned) when a restore point is due.
  void before(const Observation& observation, localization::Localizer& localizer);
  /// After it; frame: the map's.
  void after(const Observation& observation, const Pose2Gaussian& map_from_robot,
             const std::string& frame);
  /// In place of after(): the scan led to another filter, which nothing here can repeat. A gap.
  void leave_out() { ++next_scan_; }
  [[nodiscard]] bool is_read() const { return points_->matched() > 0; }
  /// Somebody reads, and no restore point could be made: the model has learned too much.
  [[nodiscard]] bool lacks_points() const { return lacks_points_; }

 private:
  [[nodiscard]] bool is_due(Stamp stamp) const;

  std::shared_ptr<bus::RawWriter> scans_;
  std::shared_ptr<bus::RawWriter> points_;
  std::function<RestorePoint()> make_point_;
  Limits limits_;
  std::uint64_t next_scan_;
  bool is_interrupted_ = true;
  int readers_ = 0;  ///< of restore points, at the last one
  std::optional<Stamp> last_point_;
  std::optional<Stamp> last_try_;  ///< that gave none
  bool lacks_points_ = false;
};

}  // namespace strata::localizer
