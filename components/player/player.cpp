// SPDX-License-Identifier: Apache-2.0
#include "components/player/player.hpp"

#include <chrono>

#include "components/log/log_reader.hpp"

namespace strata::player {

Player::~Player() { stop(); }

void Player::on_configure() {
  config_ = read_parameters<PlayerConfig>();
  Outputs outputs;
  outputs.clock = advertise<rosgraph_msgs::msg::Clock>("/clock", "default");
  outputs.tf_static = advertise<tf2_msgs::msg::TFMessage>("/tf_static", "tf_static");
  outputs.tf = advertise<tf2_msgs::msg::TFMessage>("/tf", "tf");
  outputs.odometry = advertise<nav_msgs::msg::Odometry>("odom", "default");
  outputs.scan = advertise<sensor_msgs::msg::LaserScan>("scan", "default");
  player_ = std::make_unique<LogPlayer>(log::read_observations(config_.log), std::move(outputs));
}

void Player::on_activate() {
  stopped_ = false;
  thread_ = std::thread([this] { play(); });
}

void Player::on_deactivate() { stop(); }

void Player::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Player::play() {
  const auto& observations = player_->observations();
  const auto begin = std::chrono::steady_clock::now();
  try {
    for (std::size_t i = 0; i < observations.size(); ++i) {
      const Duration since = observations[i].scan.stamp - observations.front().scan.stamp;
      const auto due = begin + std::chrono::nanoseconds(static_cast<std::int64_t>(
                                   static_cast<double>(since.ns) / config_.rate));
      {
        std::unique_lock lock(mutex_);
        if (changed_.wait_until(lock, due, [&] { return stopped_; })) return;
      }
      player_->publish(i);
    }
  } catch (const std::exception& error) {
    if (context().on_error) context().on_error(full_name() + ": " + error.what());
  }
}

}  // namespace strata::player
