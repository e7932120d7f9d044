// SPDX-License-Identifier: Apache-2.0
#include "components/player/player.hpp"

#include "components/log/log_reader.hpp"
#include "core/base/error.hpp"

namespace strata::player {

Player::~Player() { stop(); }

void Player::on_configure() {
  config_ = read_parameters<PlayerConfig>();
  source_ = make_source();
  rate_ = config_.rate;
  paused_ = config_.paused;
  from_ = Duration::from_seconds(config_.start_s);
  wanted_.reset();
  if (from_.ns > 0) wanted_ = from_;
}

std::unique_ptr<Source> Player::make_source() {
  auto clock = advertise<rosgraph_msgs::msg::Clock>("/clock", "default");
  if (config_.mode == PlayMode::kMessages) {
    return std::make_unique<BagSource>(
        config_.log, config_.topics,
        [this](const log::BagTopic& topic) {
          return advertise_raw(resolve(topic.name), topic.type, recorded_qos(topic));
        },
        std::move(clock));
  }
  Outputs outputs;
  outputs.clock = std::move(clock);
  outputs.tf_static = advertise<tf2_msgs::msg::TFMessage>("/tf_static", "tf_static");
  outputs.tf = advertise<tf2_msgs::msg::TFMessage>("/tf", "tf");
  outputs.odometry = advertise<nav_msgs::msg::Odometry>("odom", "default");
  outputs.scan = advertise<sensor_msgs::msg::LaserScan>("scan", "default");
  return std::make_unique<ScanSource>(
      LogPlayer(log::read_observations(config_.log), std::move(outputs)));
}

void Player::on_activate() {
  stopped_ = false;
  since_ = Clock::now();
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

Duration Player::position(Clock::time_point now) const {
  if (paused_) return from_;
  const std::chrono::duration<double> elapsed = now - since_;
  return {from_.ns + static_cast<std::int64_t>(elapsed.count() * 1e9 * rate_)};
}

void Player::restart_clock(Duration position) {
  from_ = position;
  since_ = Clock::now();
}

void Player::pause() {
  const std::lock_guard lock(mutex_);
  restart_clock(position(Clock::now()));
  paused_ = true;
  changed_.notify_all();
}

void Player::resume() {
  const std::lock_guard lock(mutex_);
  if (paused_) restart_clock(from_);
  paused_ = false;
  changed_.notify_all();
}

void Player::set_rate(double rate) {
  if (!(rate > 0.0)) throw ConfigError("rate", "is not positive", "give 1 for the log's own pace");
  const std::lock_guard lock(mutex_);
  restart_clock(position(Clock::now()));
  rate_ = rate;
  changed_.notify_all();
}

void Player::seek(Duration since_begin) {
  const std::lock_guard lock(mutex_);
  wanted_ = since_begin;
  restart_clock(since_begin);
  changed_.notify_all();
}

bool Player::is_paused() const {
  const std::lock_guard lock(mutex_);
  return paused_;
}

bool Player::is_over() const {
  const std::lock_guard lock(mutex_);
  return over_;
}

void Player::play() {
  try {
    std::unique_lock lock(mutex_);
    while (!stopped_) {
      if (play_next(lock)) continue;
      if (config_.loop) {
        wanted_ = Duration{};
        restart_clock({});
        continue;
      }
      over_ = true;
      changed_.wait(lock, [&] { return stopped_ || wanted_.has_value(); });
      over_ = false;
    }
  } catch (const std::exception& error) {
    if (context().on_error) context().on_error(full_name() + ": " + error.what());
  }
}

/// Waits for one step and publishes it, or does what was asked meanwhile; false at the end.
bool Player::play_next(std::unique_lock<std::mutex>& lock) {
  if (wanted_) {
    source_->seek(*wanted_);
    wanted_.reset();
  }
  Duration due;
  if (!source_->peek(due)) return false;
  const Duration left = due - position(Clock::now());
  if (paused_) {
    changed_.wait(lock);
    return true;
  }
  if (left.ns > 0) {
    const std::chrono::duration<double> wall(left.seconds() / rate_);
    changed_.wait_for(lock, wall);
    return true;  // the pace or the place may be another by now
  }
  lock.unlock();
  source_->step();
  lock.lock();
  return true;
}

}  // namespace strata::player
