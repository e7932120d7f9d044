// SPDX-License-Identifier: Apache-2.0
/// Scans in, visits of landmarks out: the front of the topology filter.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/topology/landmark_detector.hpp"
#include "core/topology/local_cloud.hpp"
#include "core/topology/topology_filter.hpp"

namespace strata::topology {

/// Where landmarks come from.
enum class LandmarkSource { kDetected, kGiven };

struct LandmarkVisitConfig {
  LandmarkSource source = LandmarkSource::kDetected;
  LandmarkConfig detector;
  LocalCloudConfig cloud;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("source", c.source,
            {.doc = "detected: junctions and rooms from the scans; given: by hand or by events"});
    v.group("detector", c.detector, "finding junctions and rooms");
    v.renamed("patch", "cloud");
    v.group("cloud", c.cloud, "local clouds around landmarks");
  }
};

/// A visit with where it belongs in the run.
struct MadeVisit {
  LandmarkVisit visit;
  Pose2 robot_from_visit;  ///< the landmark's frame seen from the robot at the visit's stamp
};

/// Makes the visits of one run. Not thread-safe; two objects are independent.
class VisitMaker {
 public:
  explicit VisitMaker(const LandmarkVisitConfig& config)
      : config_(config), detector_(config.detector) {}

  /// The next scan; map_from_robot: by odometry, corrected by scan matching or not, in a frame that
  /// may drift but never jumps. A stamp not after the last one is left out. Returns the visits
  /// whose surroundings are complete: the robot has gone on by the radius of their local cloud.
  /// O(1) about but where the detector looks around and visits are made.
  [[nodiscard]] std::vector<MadeVisit> add(const PosedScan& scan);
  /// The robot is (or was, a moment ago) at a landmark: of the scan nearest to that moment. Beside
  /// those that are found, or alone with `source: given`. False, and counted, when it comes too
  /// late or too many wait for their moment; one within half a metre of the last visit, by the way
  /// of the robot, is counted when its moment comes.
  bool mark(Stamp stamp);
  /// Whatever is left.
  [[nodiscard]] std::vector<MadeVisit> finish();
  /// Landmarks left out: by their time or place not after the one before, or one too many.
  [[nodiscard]] std::size_t late() const { return late_; }

 private:
  struct Place {
    Stamp stamp;
    std::optional<Eigen::Vector2d> center_m;  // or where the robot is
  };
  struct Passed {
    PosedScan scan;
    double path_length_m = 0.0;
  };
  void wait_for(const Place& place);
  [[nodiscard]] std::vector<MadeVisit> make(bool all);
  [[nodiscard]] std::size_t nearest(Stamp stamp) const;
  void forget_far_scans();
  LandmarkVisitConfig config_;
  LandmarkDetector detector_;
  std::vector<Passed> passed_;  // of the last metres, subsampled
  std::vector<Place> waiting_;  // in the order of their stamps
  double path_length_m_ = 0.0;
  std::optional<double> last_visit_path_length_m_;
  std::optional<Stamp> last_visit_;
  std::size_t late_ = 0;
};

}  // namespace strata::topology

template <>
struct strata::EnumNames<strata::topology::LandmarkSource> {
  static constexpr std::array values{
      std::pair{strata::topology::LandmarkSource::kDetected, "detected"},
      std::pair{strata::topology::LandmarkSource::kGiven, "given"}};
};
