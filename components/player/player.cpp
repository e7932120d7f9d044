// SPDX-License-Identifier: Apache-2.0
#include "components/player/player.hpp"

#include <algorithm>

#include "components/log/log_reader.hpp"
#include "core/base/error.hpp"

namespace strata::player {

Player::~Player() { stop(); }

void Player::on_configure() {
  config_ = read_parameters<PlayerConfig>();
  source_ = make_source();
  rate_ = config_.rate;
  paused_ = config_.paused;
  over_ = false;
  from_ = Duration::from_seconds(config_.start_s);
  if (from_.ns > 0 && !source_->seek(from_)) {
    throw ConfigError(full_name() + ".start_s", "is behind the end of " + config_.log,
                      "see `strata info` for how long it is");
  }
  serve();
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
    restart_clock(position(Clock::now()));
    stopped_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

Duration Player::position(Clock::time_point now) const {
  if (paused_ || stopped_) return from_;
  constexpr double kLongest_ns = 4e18;  // more than a century; what has ended goes on counting
  const std::chrono::duration<double> elapsed = now - since_;
  const double passed_ns = std::min(elapsed.count() * 1e9 * rate_, kLongest_ns);
  return {from_.ns + static_cast<std::int64_t>(passed_ns)};
}

void Player::restart_clock(Duration position) {
  from_ = position;
  since_ = Clock::now();
}

void Player::play() {
  try {
    std::unique_lock lock(mutex_);
    while (!stopped_) {
      if (controls_ > 0) {
        changed_.wait(lock);
        continue;
      }
      if (play_step(lock)) continue;
      if (config_.loop && source_->seek({})) {
        restart_clock({});
        continue;
      }
      over_ = true;
      changed_.wait(lock, [&] { return stopped_ || !over_; });
    }
  } catch (const std::exception& error) {
    if (context().on_error) context().on_error(full_name() + ": " + error.what());
  }
}

/// Waits for one step and publishes it, or returns when something may have changed; false at the
/// end.
bool Player::play_step(std::unique_lock<std::mutex>& lock) {
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
  is_stepping_ = true;
  lock.unlock();
  const auto done = [&] {
    lock.lock();
    is_stepping_ = false;
    changed_.notify_all();
  };
  try {
    source_->step();
  } catch (...) {
    done();
    throw;
  }
  done();
  return true;
}

}  // namespace strata::player
