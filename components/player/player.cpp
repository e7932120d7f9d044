// SPDX-License-Identifier: Apache-2.0
#include "components/player/player.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "components/log/log_reader.hpp"
#include "components/log/ros_stamps.hpp"
#include "core/base/error.hpp"

namespace strata::player {

using Wall = std::chrono::steady_clock;

/// mutex_ is free while it lives.
class Player::Unlocked {
 public:
  explicit Unlocked(Lock& lock) : lock_(lock) { lock_.unlock(); }
  ~Unlocked() { lock_.lock(); }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  Lock& lock_;
};

Player::~Player() { end(); }

void Player::on_configure() {
  config_ = read_parameters<PlayerConfig>();
  stop_ = std::stop_source();
  std::error_code error;
  if (context().dry_run && !std::filesystem::exists(config_.log, error)) return expect_log();
  source_ = make_source();
  const Duration start = Duration::from_seconds(config_.start_s);
  if (start.ns > 0 && !source_->seek(start)) {
    throw ConfigError(full_name() + ".start_s", "is behind the end of " + config_.log,
                      "see `strata info` for how long it is");
  }
  clock_ = PlayClock();
  clock_.jump(start, Wall::now());
  clock_.set_rate(config_.rate, Wall::now());
  paused_ = config_.paused;
  over_ = false;
  serve();
  thread_ = std::thread([this] { play(); });
}

/// Where a composition is only looked at, the log may come later.
void Player::expect_log() {
  (void)advertise<rosgraph_msgs::msg::Clock>("/clock", "default");
  if (config_.mode == PlayMode::kRobot) (void)robot_outputs();
  warn(InputError(config_.log, "is not there: nothing could be played",
                  "name the log, as in --set " + context().name + ".log=LOG"));
}

Outputs Player::robot_outputs() {
  Outputs outputs;
  outputs.tf_static = advertise<tf2_msgs::msg::TFMessage>("/tf_static", "tf_static");
  outputs.tf = advertise<tf2_msgs::msg::TFMessage>("/tf", "tf");
  outputs.odometry = advertise<nav_msgs::msg::Odometry>("odom", "default");
  outputs.scan = advertise<sensor_msgs::msg::LaserScan>("scan", "default");
  return outputs;
}

std::unique_ptr<Source> Player::make_source() {
  auto clock = advertise<rosgraph_msgs::msg::Clock>("/clock", "default");
  if (config_.mode == PlayMode::kMessages) {
    return std::make_unique<BagSource>(
        config_.log, config_.topics,
        [this](const log::BagTopic& topic) {
          return advertise_raw(resolve(topic.name), topic.type, recorded_qos(topic));
        },
        stop_.get_token(), std::move(clock));
  }
  Outputs outputs = robot_outputs();
  outputs.clock = std::move(clock);
  log::ReadOptions reading;
  reading.scan_topics = config_.scan_topics;
  reading.odometry_lag_s = 0.0;  // as the robot sent it
  log::LogContent content = log::read_log(config_.log, reading);
  log::require_ros_stamps(content.observations, {}, config_.log);
  // The log's own names, which other files of the robot, such as its URDF, have too.
  FrameNames frames{content.robot_frame, content.odom_frame, content.scan_frame,
                    std::move(content.scanner_frames)};
  return std::make_unique<ScanSource>(
      LogPlayer(std::move(content.observations), std::move(outputs), {}, std::move(frames)));
}

void Player::on_activate() { set_stopped(false); }

void Player::on_deactivate() { set_stopped(true); }

void Player::on_cleanup() {
  end();
  orders_.clear();
  source_.reset();  // and with it the writers
}

void Player::on_diagnose(runtime::Health& health) const {
  const std::uint64_t left_out = source_ ? source_->left_out() : 0;
  if (left_out > 0) health.warn("the log holds messages that are none");
  health.add("messages left out", left_out);
}

bool Player::is_over() const {
  const std::lock_guard lock(mutex_);
  return over_;
}

void Player::end() {
  {
    const std::lock_guard lock(mutex_);
    stop_.request_stop();
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Player::play() {
  Lock lock(mutex_);
  while (!stop_.stop_requested()) {
    if (controls_ > 0) {
      changed_.wait(lock);
    } else if (!orders_.empty()) {
      const Order order = std::move(orders_.front());
      orders_.pop_front();
      bool is_done = false;
      (void)attempt([&] { is_done = order.seek ? seek(*order.seek, lock) : play_next(lock); });
      (void)attempt([&] {
        const Unlocked unlocked(lock);
        order.answer(is_done);
      });
    } else if (stopped_ || paused_ || over_) {
      changed_.wait(lock);
    } else if (!attempt([&] { play_step(lock); })) {
      over_ = true;
    }
  }
}

bool Player::attempt(const std::function<void()>& body) {
  try {
    body();
    return true;
  } catch (const std::exception& error) {
    if (context().on_error) context().on_error(full_name() + ": " + error.what());
    return false;
  }
}

void Player::play_step(Lock& lock) {
  const std::optional<Duration> due = fetch(lock);
  over_ = !due;
  // Meanwhile others may have said something else.
  if (!due || controls_ > 0 || !orders_.empty() || stopped_ || paused_) return;
  const auto wait = clock_.wait(*due, Wall::now());
  if (wait.count() > 0) {
    changed_.wait_for(lock, wait);
  } else {
    step(lock);
  }
}

std::optional<Duration> Player::fetch(Lock& lock) {
  Duration due;
  bool begins_again = false;
  {
    const Unlocked unlocked(lock);
    if (!source_->peek(due)) {
      begins_again = config_.loop && source_->seek({}) && source_->peek(due);
      if (!begins_again) return std::nullopt;
    }
  }
  if (begins_again) clock_.jump({}, Wall::now());
  return due;
}

void Player::step(Lock& lock) {
  is_stepping_ = true;
  const auto publish = [&] {
    const Unlocked unlocked(lock);
    source_->step();
  };
  over_ = !attempt(publish);
  is_stepping_ = false;
  changed_.notify_all();
}

bool Player::seek(Stamp time, Lock& lock) {
  const Duration before = clock_.position(Wall::now());
  std::optional<Duration> found;
  const auto look = [&] {
    const Unlocked unlocked(lock);
    const std::optional<Stamp> begin = source_->begin();
    if (!begin) return;
    const Duration place = std::max(since(*begin, time), Duration{});
    if (source_->seek(place)) found = place;
  };
  (void)attempt(look);
  // The clock has run on meanwhile; nothing is to be caught up with.
  clock_.jump(found.value_or(before), Wall::now());
  if (!found) return false;
  over_ = false;
  return true;
}

bool Player::play_next(Lock& lock) {
  if (!paused_ || stopped_) return false;
  const std::optional<Duration> due = fetch(lock);
  if (!due || !paused_ || stopped_) return false;
  clock_.jump(*due, Wall::now());
  step(lock);
  return !over_;
}

}  // namespace strata::player
