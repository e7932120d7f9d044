// SPDX-License-Identifier: Apache-2.0
/// strata::Player: a log in; what a robot published out, at the pace of the log.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "components/player/config.hpp"
#include "components/player/play_clock.hpp"
#include "components/player/source.hpp"
#include "components/runtime/component.hpp"

namespace strata::player {

/// Live only: in lockstep `strata replay` plays. Controlled as rosbag2's player, by services
/// ~/pause, ~/resume, ~/toggle_paused, ~/is_paused, ~/get_rate, ~/set_rate, ~/seek and
/// ~/play_next, and by the parameters `rate` and `paused`, which say the same. The log is read on a
/// thread of its own: however long that takes, the services answer.
class Player final : public runtime::Component {
 public:
  using Component::Component;
  ~Player() override;

  /// Whether all was played, or what is left cannot be. Thread safe.
  [[nodiscard]] bool is_over() const;

 private:
  class Control;
  class Unlocked;
  using Lock = std::unique_lock<std::mutex>;

  /// What the playing thread is asked for besides playing.
  struct Order {
    std::optional<Stamp> seek;         ///< without: the next step
    std::function<void(bool)> answer;  ///< whether it was done
  };

  void on_declare() override { declare_parameters<PlayerConfig>(); }
  void on_configure() override;
  void on_activate() override;
  void on_deactivate() override;
  void on_cleanup() override;
  void on_diagnose(runtime::Health& health) const override;
  [[nodiscard]] std::unique_ptr<Source> make_source();
  void expect_log();
  /// Without the clock.
  [[nodiscard]] Outputs robot_outputs();
  /// Ends the playing thread, whatever it reads.
  void end();

  // On the playing thread, which lives from configure to cleanup; each is called and returns with
  // mutex_ locked.
  void play();
  /// False when `body` failed, which is told.
  [[nodiscard]] bool attempt(const std::function<void()>& body);
  /// Waits for one step and publishes it, or returns when something may have changed.
  void play_step(Lock& lock);
  /// When the next step is due; none at the end of the log, which may be its beginning again.
  [[nodiscard]] std::optional<Duration> fetch(Lock& lock);
  void step(Lock& lock);
  [[nodiscard]] bool seek(Stamp time, Lock& lock);
  [[nodiscard]] bool play_next(Lock& lock);

  // Controls (player_services.cpp). What they say holds once they return or answer: nothing is
  // being played from before.
  void serve();
  void set_paused(bool paused);
  void set_rate(double rate);
  void set_stopped(bool stopped);
  [[nodiscard]] bool is_paused();
  /// A seek takes the place of those that still wait: they are answered with false.
  void give(Order order);

  PlayerConfig config_;
  std::unique_ptr<Source> source_;  ///< the playing thread's, while there is one
  std::stop_source stop_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Under mutex_.
  PlayClock clock_;  ///< runs while neither paused nor stopped
  bool paused_ = false;
  bool stopped_ = true;
  bool over_ = false;         ///< nothing is left to play, or it could not be
  bool is_stepping_ = false;  ///< the playing thread publishes, without mutex_
  int controls_ = 0;          ///< wait for the playing thread, which lets them go first
  std::deque<Order> orders_;
  std::thread thread_;
};

/// While one lives nothing is played; it holds mutex_.
class Player::Control {
 public:
  explicit Control(Player& player);
  ~Control();
  Control(const Control&) = delete;
  Control& operator=(const Control&) = delete;

 private:
  Player& player_;
  Lock lock_;
};

}  // namespace strata::player
