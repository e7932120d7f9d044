// SPDX-License-Identifier: Apache-2.0
/// Incremental scan matching of one run: where is the robot, relative to where it just was.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "core/geometry/odometry_gate.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/registration/scan_matcher.hpp"
#include "core/scan/endpoints.hpp"
#include "core/scan/scan.hpp"
#include "core/scan/scanner_turns.hpp"
#include "core/tracking/local_map.hpp"
#include "core/tracking/scan_findings.hpp"
#include "core/tracking/surface_map.hpp"
#include "core/tracking/tracking_config.hpp"

namespace strata::slam {

/// The hits of a scan that take part in matching, in the robot frame: without those that are more
/// likely dynamic than static. static_probability: e(t,n), or empty for 1.
[[nodiscard]] Endpoints match_endpoints(const Scan& scan, double max_range_m, int max_beams,
                                        std::span<const float> static_probability = {});

/// What the tracker made of one scan.
struct TrackedScan {
  Pose2Gaussian run_from_robot;  ///< in the run's own frame, which drifts but never jumps
  bool matched = false;          ///< false: the odometry (or motion) guess alone
  bool key = false;              ///< entered the map (motion gate)
  ScanFindings findings;
};

/// Matches each scan to the older of two overlapping local maps under construction [hess2016real]
/// (docs/theory/slam.md, "Incremental map"): each holds 2 n key scans, a new one begins every n, so
/// the map matched against always holds at least n; late loop errors cannot reach it. Where key
/// scans lie far apart the path's length decides: what is trusted whole must not grow with them.
class Tracker {
 public:
  Tracker(const TrackingConfig& config, double resolution_m, int run, const Pose2& start);

  /// odom_from_robot: null without odometry; then the last motion is continued, and of scans that
  /// match nothing none enters the map until there are many in a row. scan_index: the
  /// caller's number of the scan, used for the local maps' ranges. given: null, or a pose that came
  /// with the log, in the run's frame; where the scan is ambiguous (a bare corridor) it rules.
  /// Odometry that moves faster than a robot can is not believed for that scan. static_probability:
  /// e(t,n) where an earlier pass found it; the weights of eq. (1.11) [stachniss2003chapter].
  /// Several scanners (told by their mountings) share max_beams and take turns in the map.
  /// Scans without usable hits move by odometry. O(beams x iterations), plus O(cells crossed) for
  /// key scans.
  TrackedScan add(const Scan& scan, const Pose2* odom_from_robot, std::size_t scan_index,
                  const Pose2Gaussian* given = nullptr,
                  std::span<const float> static_probability = {});

  /// Local maps that were finished since the last call, in order; takes them out.
  [[nodiscard]] std::vector<LocalMap> take_finished();
  /// Ends the run: whatever is under construction becomes a local map.
  void finish(std::size_t end_scan);

  /// For saved states; configs, resolution and run are the constructor's.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    if constexpr (std::is_const_v<Self>) {
      archive(static_cast<std::uint64_t>(self.active_.size()));
    } else {
      self.begin_maps(archive.length(1));
    }
    for (auto& active : self.active_) {
      archive(active.map);
      archive(active.keys);
      archive(active.from_m);
    }
    archive(self.started_);
    archive(self.first_scan_);
    archive(self.pose_);
    archive(self.last_pose_);
    archive(self.recent_);
    archive(self.lost_);
    archive(self.last_stamp_);
    archive(self.odometry_);
    archive(self.path_m_);
    archive(self.doubt_);
    archive(self.last_key_);
    archive(self.turns_);
    archive(self.drift_);
    archive(self.owned_drift_);
    archive(self.owned_from_);
    archive(self.owned_pose_);
    archive(self.finished_);
  }
  /// Whether its local maps are of so many scans; else a state was damaged.
  [[nodiscard]] bool is_sound(std::size_t scans) const;

 private:
  struct Active {
    SurfaceMap map;
    int keys = 0;
    double from_m = 0.0;  ///< path of the run at its beginning
  };
  [[nodiscard]] Pose2Gaussian predict(const Scan& scan, const Pose2* step) const;
  [[nodiscard]] Pose2 going_on(Stamp until) const;
  void remember(Stamp stamp);
  [[nodiscard]] std::vector<Pose2> other_guesses(const Pose2Gaussian& guess) const;
  enum class GuessFrom { kMotion, kOdometry, kGivenPose };
  /// hits: of the whole scan, dynamic ones too, subsampled as the end points are.
  [[nodiscard]] bool locate(const Endpoints& endpoints, std::size_t hits,
                            const Pose2Gaussian& guess, GuessFrom from, Pose2Gaussian& found,
                            Eigen::Matrix3d& information) const;
  [[nodiscard]] std::optional<registration::MatchResult> match_still_alone(
      const Endpoints& endpoints, const Pose2Gaussian& guess) const;
  void doubt_odometry(const ScanFindings& findings);
  void grow_drift(const Pose2& step, const Pose2Gaussian* given);
  [[nodiscard]] bool is_complete(const Active& active) const;
  void insert(const Scan& scan, std::size_t scan_index, std::span<const float> static_probability);
  void close_oldest(std::size_t end_scan);
  /// Maps without anything in them, to restore a state into.
  void begin_maps(std::size_t count);

  TrackingConfig config_;
  double resolution_m_;
  int run_;
  bool started_ = false;  // some scan hit something
  std::optional<std::size_t> first_scan_;
  Pose2Gaussian pose_;
  Pose2 last_pose_;
  struct Recent {
    Stamp stamp;
    Pose2 pose;
  };
  std::vector<Recent> recent_;  // the last few scans
  int lost_ = 0;                // scans in a row that matched nothing, without odometry
  Stamp last_stamp_;
  OdometryGate odometry_;
  ScannerTurns turns_;
  double path_m_ = 0.0;
  double doubt_ = 1.0;  // of odometry; shrinks while it agrees with the matches
  std::optional<Pose2> last_key_;
  std::vector<Active> active_;
  // Uncertainty of the pose against the beginning of the oldest active local map, in the run's
  // frame: grows with the motion, shrinks by what each match sees of the map.
  Eigen::Matrix3d drift_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d owned_drift_ = Eigen::Matrix3d::Zero();  // drift_ when that local map took over
  std::size_t owned_from_ = 0;  // first scan that belongs to the oldest active local map
  Pose2 owned_pose_;            // robot's pose there
  std::vector<LocalMap> finished_;
};

}  // namespace strata::slam
