// SPDX-License-Identifier: Apache-2.0
/// strata::TopologyMapper: scans, odometry and landmarks by hand in; the posterior over topologies
/// out, after each landmark.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "components/runtime/sensor_component.hpp"
#include "components/topology_mapper/config.hpp"
#include "components/topology_mapper/mapper_store.hpp"
#include "core/topology/topology_mapper.hpp"

namespace strata::topology_mapper {

/// In, beside scans and odometry: landmark (geometry_msgs/PointStamped), given_pose (ScanPose, as
/// strata::ScanMatcher takes it). Out: topologies (Topologies); at the end of a log, or of the
/// component's work, the files that `strata topology` writes, without its pictures. It tracks the
/// robot itself: the poses of strata::ScanMatcher jump where it closes a loop, which is what is
/// to be decided here. Live it goes on from its store. Once the clock was set back its stamps are
/// ahead of that by the `seconds added to stamps` of /diagnostics: the way has one time.
class TopologyMapper final : public runtime::SensorComponent {
 public:
  using SensorComponent::SensorComponent;

 private:
  void on_declare() override { declare_parameters<TopologyMapperComponentConfig>(); }
  void on_configure() override;
  void on_activate() override;
  void on_deactivate() override;
  void on_tick() override;
  void on_cleanup() override;
  void on_finish(const std::filesystem::path& out_dir) override;
  void on_diagnose(runtime::Health& health) const override;
  void on_observation(const Observation& scanned) override;
  [[nodiscard]] std::string on_clock_set_back() override;
  [[nodiscard]] bool learns() const override { return true; }
  void make_mapper();
  void open_store();
  /// Decides how the first scan goes on from what was kept; false when that cannot be told before
  /// odometry comes.
  [[nodiscard]] bool resume(const Observation& first);
  [[nodiscard]] bool has_gone_on(const runtime::KeptMoment& kept, const Observation& first);
  /// What the newest kept scans saw, in the frame of their poses.
  [[nodiscard]] ReflectionGrid newest_surroundings() const;
  /// The next scan follows on the newest one of the way, though its clock is behind that.
  void go_on_after(Stamp newest, Stamp first);
  /// stamp: in the way's time.
  void mark(Stamp stamp);
  void on_landmark(const geometry_msgs::msg::PointStamped& message);
  void update(std::vector<topology::MadeVisit> visits);
  void publish();
  void write(const std::filesystem::path& folder, Progress* progress);

  TopologyMapperComponentConfig config_;
  std::unique_ptr<topology::TopologyMapper> mapper_;
  std::optional<strata_msgs::msg::ScanPose> given_;
  std::optional<Stamp> last_scan_;
  std::optional<MapperStore> store_;
  std::optional<topology::TrackedMoment> restored_;  ///< until the first scan comes
  bool waits_for_odometry_ = false;                  ///< to go on from there
  bool is_set_back_ = false;                         ///< the clock, and no scan has come since
  Duration ahead_;                                   ///< the way's time, of the scans' clock
  std::chrono::steady_clock::time_point flushed_;
  double update_s_ = 0.0;      ///< wall clock of the last landmark
  double max_update_s_ = 0.0;  ///< ... and of the slowest
  std::function<void(const strata_msgs::msg::Topologies&)> publish_;
};

}  // namespace strata::topology_mapper
