// SPDX-License-Identifier: Apache-2.0
/// A localizer's run gone through again from what its journal kept.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "strata_idl/strata_msgs.h"

#include "components/localizer/restore_point.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/localization/localizer.hpp"

namespace strata::localizer {

/// A scan of the journal as it came out again.
struct ReplayedScan {
  Stamp stamp;
  Pose2Gaussian recorded;  ///< map_from_robot
  Pose2Gaussian replayed;
  bool is_same = false;  ///< every bit of mean and covariance
};

/// What was kept of one localizer's run; the entries may come in any order.
class JournalReplay {
 public:
  /// The folder that holds the maps of a restore point now. Throws InputError when there is none.
  using FindMaps = std::function<std::filesystem::path(const RestorePoint&)>;
  /// After each scan that was gone through.
  using OnScan = std::function<void(const ReplayedScan&, const localization::Localizer&)>;

  void add(RestorePoint point);
  /// A message that a restore point's maps came with (wanted()).
  void add(const MapMessage& message, std::vector<std::uint8_t> cdr);
  /// Throws InputError for a scan that is none.
  void add(const strata_msgs::msg::LabeledScan& scan);

  /// Of which messages the restore points' maps are.
  [[nodiscard]] std::vector<MapMessage> wanted() const;

  struct Outcome {
    std::size_t scans = 0;         ///< in the journal
    std::size_t replayed = 0;      ///< those since the first restore point, up to gaps
    std::size_t same = 0;          ///< of those, to every bit
    std::size_t restored = 0;      ///< times that the filter was taken from a restore point
    std::size_t without_maps = 0;  ///< restore points whose messages were not kept
    std::size_t compared = 0;      ///< restore points that the scans before should have led to
    std::size_t same_states = 0;   ///< ... and did, to every bit of the filter
    std::optional<Stamp> first_difference;
    [[nodiscard]] bool is_same() const {
      return replayed > 0 && same == replayed && same_states == compared;
    }
  };
  /// In the order of the scans; threads: as WorkerPool, of no consequence for the result. Throws
  /// InputError when there is no restore point, or none whose maps are known, when a folder of maps
  /// is not found, and for damaged states.
  [[nodiscard]] Outcome run(const FindMaps& find_maps, int threads, const OnScan& on_scan) const;

 private:
  struct Entry {
    Observation observation;
    Pose2Gaussian map_from_robot;
  };
  [[nodiscard]] bool has_maps_of(const RestorePoint& point) const;

  std::map<std::uint64_t, RestorePoint> points_;               ///< by the next scan
  std::map<std::string, std::vector<std::uint8_t>> messages_;  ///< of maps, by their SHA-256
  std::map<std::uint64_t, Entry> scans_;                       ///< by number
};

}  // namespace strata::localizer
