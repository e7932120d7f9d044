// SPDX-License-Identifier: Apache-2.0
/// strata::VolumeMapper: point clouds and tf in, a 3-D map of what stands still out.
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "components/log/transform_history.hpp"
#include "components/runtime/component.hpp"
#include "components/volume_mapper/config.hpp"
#include "components/volume_mapper/live_levels.hpp"
#include "components/volume_mapper/share_of_time.hpp"
#include "components/volume_mapper/told_health.hpp"
#include "core/volume/point_colors.hpp"
#include "core/volume/stored_columns.hpp"
#include "core/volume/volume_map.hpp"

namespace strata::volume_mapper {

/// In: points (sensor_msgs/PointCloud2), /tf, /tf_static, labeled_scan, and the localizer's health
/// when asked. Out: octomap_binary, and
/// octomap_color once clouds have colours, and octomap_level/short, mid and long when asked. A
/// cloud waits until tf tells where it was seen from. Clouds that make no sense, or whose pose
/// stays unknown, are dropped and counted on /diagnostics; the map is as before. Live, publishing
/// takes at most a tenth of the time: a large map goes out less often than publish_period_s says,
/// whatever the stamps.
class VolumeMapper final : public runtime::Component {
 public:
  using Component::Component;

 private:
  struct Waiting {
    volume::Cloud cloud;
    std::string frame;
    std::vector<float> offset_s;  ///< of each point; empty: unknown, or not asked for
    Stamp last;                   ///< when its last point was measured
  };
  struct FrameCheck {
    volume::StoredColumns columns;
    FrameWatch watch;
    std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now();
  };
  void on_declare() override { declare_parameters<VolumeMapperConfig>(); }
  void on_configure() override;
  void on_activate() override;
  void on_tick() override;
  void on_deactivate() override;
  void on_finish(const std::filesystem::path& out_dir) override;
  void on_cleanup() override;
  void on_diagnose(runtime::Health& health) const override;
  void on_transforms(const tf2_msgs::msg::TFMessage& message, bool is_static);
  void on_cloud(const sensor_msgs::msg::PointCloud2& message);
  void on_scan(const strata_msgs::msg::LabeledScan& message);
  void on_health(const strata_msgs::msg::LocalizationHealth& message);
  /// Enters the clouds whose pose is known by now, in order.
  void work_off();
  [[nodiscard]] bool is_labeled(Stamp stamp) const;
  /// Whether the localizer was sure of where the robot was, if it is asked; nothing: not known yet.
  [[nodiscard]] std::optional<bool> sure_of_place(const Waiting& waiting) const;
  /// Finds where the cloud was seen from; false while that is not known up to its last point.
  bool find_poses(Waiting& waiting) const;
  void enter(const volume::Cloud& cloud);
  void publish_map_of(Stamp newest_cloud);
  void publish(Stamp stamp);
  void advertise_maps();
  /// A new map, or the stored one.
  [[nodiscard]] volume::VolumeMap first_map();
  /// None, or the stored ones.
  [[nodiscard]] volume::PointColors first_colors();
  [[nodiscard]] bool has_colors() const { return colors_ && !colors_->is_empty(); }
  /// Beside the store.
  [[nodiscard]] std::filesystem::path color_store() const;
  /// Whether the store is of the frame that poses come in.
  void check_frame(const volume::Cloud& cloud);
  /// Sets the store aside, which is not.
  void begin_anew();
  [[nodiscard]] bool may_keep() const;
  /// Writes the map to the store when it has changed.
  void keep();

  VolumeMapperConfig config_;
  std::optional<volume::VolumeMap> map_;
  std::optional<volume::PointColors> colors_;  ///< nothing: not asked for
  std::optional<LiveLevels> levels_;           ///< nothing: not asked for
  std::optional<WorkerPool> pool_;
  log::TransformHistory transforms_;
  std::deque<Waiting> waiting_;
  std::vector<volume::DynamicPoint> moving_;
  volume::CloudCounts counts_;
  std::size_t clouds_ = 0;
  std::optional<FrameCheck> frame_;  ///< while it is open, with what a store held
  bool is_store_foreign_ = false;    ///< of another frame, and could not be set aside
  std::size_t kept_clouds_ = 0;      ///< as of the last write to the store
  std::chrono::steady_clock::time_point kept_;
  std::size_t without_pose_ = 0;
  std::size_t not_localized_ = 0;   ///< clouds that were passed over
  std::size_t without_health_ = 0;  ///< clouds that waited for it in vain
  ToldHealth health_;
  std::optional<Stamp> last_label_;
  std::optional<Stamp> last_published_;
  ShareOfTime publishing_;          ///< live
  std::optional<Stamp> held_back_;  ///< of the newest cloud whose map was due, but cost too much
  std::function<void(const octomap_msgs::msg::Octomap&)> publish_;
  std::function<void(const octomap_msgs::msg::Octomap&)> publish_colors_;
  std::vector<std::function<void(const octomap_msgs::msg::Octomap&)>> publish_levels_;
};

}  // namespace strata::volume_mapper
