// SPDX-License-Identifier: Apache-2.0
/// What a localizer tells while somebody records it, so that its run can be gone through again.
#pragma once

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
  /// make_point: a restore point but for scan and state. period: between two of them, by stamps.
  Journal(std::shared_ptr<bus::RawWriter> scans, std::shared_ptr<bus::RawWriter> points,
          std::function<RestorePoint()> make_point, Duration period);

  /// Something else than a scan has changed the filter: the next scan begins anew.
  void interrupt() { is_interrupted_ = true; }
  /// Before the scan is worked on. O(particles) when a restore point is due.
  void before(const Observation& observation, const localization::Localizer& localizer);
  /// After it; frame: the map's.
  void after(const Observation& observation, const Pose2Gaussian& map_from_robot,
             const std::string& frame);

 private:
  [[nodiscard]] bool is_due(Stamp stamp) const;

  std::shared_ptr<bus::RawWriter> scans_;
  std::shared_ptr<bus::RawWriter> points_;
  std::function<RestorePoint()> make_point_;
  Duration period_;
  std::uint64_t next_scan_;
  bool is_interrupted_ = true;
  int readers_ = 0;  ///< of restore points, at the last one
  std::optional<Stamp> last_point_;
};

}  // namespace strata::localizer
