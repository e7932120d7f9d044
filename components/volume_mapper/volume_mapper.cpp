// SPDX-License-Identifier: Apache-2.0
#include "components/volume_mapper/volume_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "components/convert/cloud_messages.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/whole_file.hpp"
#include "core/scan/undistort.hpp"
#include "core/volume/level_tree.hpp"

namespace strata::volume_mapper {
namespace {

/// How long tf and labels are remembered; clouds that wait longer are given up.
constexpr double kRemembered_s = 10.0;

std::vector<volume::Rgb> unpacked(const std::vector<std::uint32_t>& rgb) {
  std::vector<volume::Rgb> colors(rgb.size());
  std::transform(rgb.begin(), rgb.end(), colors.begin(), [](std::uint32_t packed) {
    return volume::Rgb{static_cast<std::uint8_t>(packed >> 16),
                       static_cast<std::uint8_t>(packed >> 8), static_cast<std::uint8_t>(packed)};
  });
  return colors;
}

}  // namespace

void VolumeMapper::on_configure() {
  config_ = read_parameters<VolumeMapperConfig>();
  frame_.reset();
  keep_live(config_, {"publish_period_s", "leave_out_moving"});
  map_.emplace(first_map());
  colors_.reset();
  if (config_.has_colors) colors_.emplace(first_colors());
  levels_.reset();
  if (config_.has_levels) levels_.emplace(config_);
  kept_ = std::chrono::steady_clock::now();
  pool_.emplace(context().threads);
  transforms_ = log::TransformHistory(kRemembered_s);
  health_ = ToldHealth(kRemembered_s);
  advertise_maps();
  subscribe<tf2_msgs::msg::TFMessage>(
      "/tf_static", "tf_static", [this](const auto& message) { on_transforms(message, true); });
  subscribe<tf2_msgs::msg::TFMessage>(
      "/tf", "tf", [this](const auto& message) { on_transforms(message, false); });
  subscribe<strata_msgs::msg::LabeledScan>("labeled_scan", "lossless",
                                           [this](const auto& message) { on_scan(message); });
  if (!config_.health_topic.empty()) {
    // Latched ones keep one: while a cloud is entered others would be lost.
    subscribe<strata_msgs::msg::LocalizationHealth>(
        config_.health_topic, "tf", [this](const auto& message) { on_health(message); });
  }
  subscribe<sensor_msgs::msg::PointCloud2>("points", config_.points_qos,
                                           [this](const auto& message) { on_cloud(message); });
}

void VolumeMapper::advertise_maps() {
  using octomap_msgs::msg::Octomap;
  publish_ = advertise<Octomap>(config_.topic, "latched");
  publish_colors_ = nullptr;
  publish_levels_.clear();
  if (colors_) publish_colors_ = advertise<Octomap>(config_.color_topic, "latched");
  if (!levels_) return;
  for (const auto& [level, name] : kLevels) {
    publish_levels_.push_back(advertise<Octomap>(config_.level_topic + "/" + name, "latched"));
  }
}

void VolumeMapper::on_activate() {
  if (map_->size().leaves > 0) publish(now());
}

void VolumeMapper::on_tick() {
  const std::chrono::duration<double> since = std::chrono::steady_clock::now() - kept_;
  if (since.count() >= config_.store_period_s && may_keep()) keep();
  if (held_back_ && publishing_.is_due(std::chrono::steady_clock::now()))
    publish_map_of(*held_back_);
}

void VolumeMapper::on_transforms(const tf2_msgs::msg::TFMessage& message, bool is_static) {
  for (const auto& transform : message.transforms()) {
    const Pose3 pose = convert::from_message(transform.transform());
    if (!pose.translation.allFinite() || !pose.rotation.coeffs().allFinite()) continue;
    const std::string& parent = transform.header().frame_id();
    if (is_static) {
      transforms_.add_fixed(parent, transform.child_frame_id(), pose);
    } else {
      transforms_.add(parent, transform.child_frame_id(),
                      convert::from_message(transform.header().stamp()), pose);
    }
  }
  work_off();
}

void VolumeMapper::on_scan(const strata_msgs::msg::LabeledScan& message) {
  const PosedScan scan = convert::from_message(message);
  for (const auto& point : volume::dynamic_points(std::span(&scan, 1))) moving_.push_back(point);
  const Stamp oldest = scan.scan.stamp - Duration::from_seconds(kRemembered_s);
  std::erase_if(moving_, [&](const auto& point) { return point.stamp < oldest; });
  last_label_ = scan.scan.stamp;
  work_off();
}

void VolumeMapper::on_health(const strata_msgs::msg::LocalizationHealth& message) {
  health_.add(convert::from_message(message.header().stamp()),
              message.localized() && !message.lost());
  work_off();
}

bool VolumeMapper::is_labeled(Stamp stamp) const {
  if (!config_.wait_for_labels) return true;
  return last_label_ && *last_label_ >= stamp + Duration::from_seconds(config_.boxes.window_s);
}

void VolumeMapper::on_cloud(const sensor_msgs::msg::PointCloud2& message) {
  Waiting waiting;
  waiting.cloud.points_m = convert::from_message(message);
  waiting.cloud.stamp = convert::from_message(message.header().stamp());
  waiting.frame = message.header().frame_id();
  waiting.last = waiting.cloud.stamp;
  convert::CloudColumns columns;
  if (config_.part_s > 0.0 || colors_) columns = convert::columns_of(message);
  if (colors_) waiting.cloud.colors = unpacked(columns.rgb);
  if (config_.part_s > 0.0 && !waiting.cloud.points_m.empty()) {
    waiting.offset_s = std::move(columns.offset_s);
    float last_s = 0.0F;
    for (float& offset_s : waiting.offset_s) {
      // A wild time is none; false for NaN.
      const bool is_sound = std::abs(static_cast<double>(offset_s)) < kLongestSweepS;
      if (!is_sound) offset_s = 0.0F;
      last_s = std::max(last_s, offset_s);
    }
    waiting.last = waiting.cloud.stamp + Duration::from_seconds(static_cast<double>(last_s));
  }
  waiting_.push_back(std::move(waiting));
  work_off();
  while (waiting_.size() > static_cast<std::size_t>(config_.waiting_clouds)) {
    const Waiting& oldest = waiting_.front();
    ++(sure_of_place(oldest) ? without_pose_ : without_health_);
    waiting_.pop_front();
  }
}

void VolumeMapper::work_off() {
  for (auto it = waiting_.begin(); it != waiting_.end();) {
    const std::optional<bool> is_sure = sure_of_place(*it);
    if (!is_sure || (*is_sure && (!is_labeled(it->last) || !find_poses(*it)))) {
      ++it;
      continue;
    }
    if (*is_sure) {
      enter(it->cloud);
    } else {
      ++not_localized_;
    }
    it = waiting_.erase(it);
  }
}

std::optional<bool> VolumeMapper::sure_of_place(const Waiting& waiting) const {
  if (config_.health_topic.empty()) return true;
  return health_.is_localized(waiting.cloud.stamp, waiting.last);
}

bool VolumeMapper::find_poses(Waiting& waiting) const {
  const auto at = [&](Stamp stamp) {
    return transforms_.find(config_.map_frame, waiting.frame, stamp);
  };
  const auto pose = at(waiting.cloud.stamp);
  if (!pose || !at(waiting.last)) return false;
  waiting.cloud.map_from_sensor = *pose;
  if (waiting.offset_s.size() == waiting.cloud.points_m.size() &&
      waiting.last != waiting.cloud.stamp) {
    (void)volume::cut_by_time(waiting.cloud, waiting.offset_s, config_.part_s, at);
  }
  return true;
}

void VolumeMapper::enter(const volume::Cloud& cloud) {
  if (frame_) check_frame(cloud);
  std::vector<std::uint8_t> is_dynamic;
  if (config_.leave_out_moving && !moving_.empty()) {
    is_dynamic = volume::DynamicBoxes(config_.boxes, moving_).label(cloud);
  }
  counts_ += map_->insert(cloud, is_dynamic, *pool_);
  if (colors_) colors_->add(cloud, is_dynamic, *pool_);
  if (levels_) levels_->see(cloud, is_dynamic, *pool_);
  ++clouds_;
  // Stamps may run backwards, as when a bag starts again.
  const bool is_due = !last_published_ || std::abs((cloud.stamp - *last_published_).seconds()) >=
                                              config_.publish_period_s;
  if (!is_due) return;
  if (lockstep() || publishing_.is_due(std::chrono::steady_clock::now())) {
    publish_map_of(cloud.stamp);
  } else {
    held_back_ = cloud.stamp;
  }
}

void VolumeMapper::publish_map_of(Stamp newest_cloud) {
  const auto begin = std::chrono::steady_clock::now();
  held_back_.reset();
  last_published_ = newest_cloud;
  publish(newest_cloud);
  publishing_.spent(begin, std::chrono::steady_clock::now());
}

void VolumeMapper::publish(Stamp stamp) {
  const double resolution_m = config_.map.resolution_m;
  const std::string& frame = config_.map_frame;
  publish_(convert::to_binary_octomap(map_->binary_message_data(), resolution_m, stamp, frame));
  if (has_colors()) {
    publish_colors_(
        convert::to_color_octomap(colors_->message_data(*map_), resolution_m, stamp, frame));
  }
  for (std::size_t i = 0; i < publish_levels_.size(); ++i) {
    publish_levels_[i](
        convert::to_binary_octomap(volume::level_message_data(levels_->memory(), kLevels[i].first),
                                   resolution_m, stamp, frame));
  }
}

void VolumeMapper::on_deactivate() {
  guarded([&] { keep(); });  // the map may have room elsewhere
  if (lockstep() || config_.save.empty() || !map_) return;
  log::write_whole_file(config_.save, map_->binary_file());
}

void VolumeMapper::on_finish(const std::filesystem::path& out_dir) {
  const std::filesystem::path folder = out_dir / config_.out_subfolder;
  std::filesystem::create_directories(folder);
  log::write_whole_file(folder / "map.bt", map_->binary_file());
  log::write_whole_file(folder / "map.ot", map_->full_file());
  if (has_colors()) log::write_whole_file(folder / "map_color.ot", colors_->file(*map_));
  if (!levels_) return;
  for (const auto& [level, name] : kLevels) {
    log::write_whole_file(folder / ("map_" + std::string(name) + ".bt"),
                          volume::level_file(levels_->memory(), level));
  }
}

void VolumeMapper::on_diagnose(runtime::Health& health) const {
  health.add("clouds", std::uint64_t{clouds_});
  health.add("clouds without pose", std::uint64_t{without_pose_});
  if (!config_.health_topic.empty()) {
    if (without_health_ > 0 && health_.is_empty()) {
      health.warn("nobody publishes " + resolve(config_.health_topic) +
                  ": no cloud enters the map");
    }
    health.add("clouds while not localized", std::uint64_t{not_localized_});
    health.add("clouds without localization health", std::uint64_t{without_health_});
  }
  health.add("points that are no numbers", std::uint64_t{counts_.not_finite});
  health.add("points taken for moving", std::uint64_t{counts_.dynamic});
}

void VolumeMapper::on_cleanup() {
  frame_.reset();
  is_store_foreign_ = false;
  map_.reset();
  colors_.reset();
  levels_.reset();
  pool_.reset();
  transforms_ = log::TransformHistory(kRemembered_s);
  waiting_.clear();
  moving_.clear();
  counts_ = {};
  clouds_ = 0;
  kept_clouds_ = 0;
  without_pose_ = 0;
  not_localized_ = 0;
  without_health_ = 0;
  health_ = ToldHealth(kRemembered_s);
  last_label_.reset();
  last_published_.reset();
  publishing_ = {};
  held_back_.reset();
}

}  // namespace strata::volume_mapper
