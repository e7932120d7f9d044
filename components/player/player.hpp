// SPDX-License-Identifier: Apache-2.0
/// strata::Player: a log in; what a robot published out, at the pace of the log.
#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "components/player/config.hpp"
#include "components/player/source.hpp"
#include "components/runtime/component.hpp"

namespace strata::player {

/// Live only: in lockstep `strata replay` plays. Controlled as rosbag2's player, by services
/// ~/pause, ~/resume, ~/toggle_paused, ~/is_paused, ~/get_rate, ~/set_rate, ~/seek and
/// ~/play_next, and by the parameters `rate` and `paused`, which say the same.
class Player final : public runtime::Component {
 public:
  using Component::Component;
  ~Player() override;

 private:
  using Clock = std::chrono::steady_clock;
  class Control;

  void on_declare() override { declare_parameters<PlayerConfig>(); }
  void on_configure() override;
  void on_activate() override;
  void on_deactivate() override;
  [[nodiscard]] std::unique_ptr<Source> make_source();
  void play();
  bool play_step(std::unique_lock<std::mutex>& lock);
  /// The place of the log that now is; under mutex_.
  [[nodiscard]] Duration position(Clock::time_point now) const;
  void restart_clock(Duration position);
  void stop();

  // Controls (player_services.cpp). What they say holds once they return: nothing is being played
  // from before.
  void serve();
  void set_paused(bool paused);
  void set_rate(double rate);
  /// False, and nothing changes, behind the end of the log; before its beginning is the beginning.
  bool seek(Stamp time);
  /// One step of a log that is paused; false when it is not, or has ended.
  bool play_next();
  [[nodiscard]] bool is_paused();
  /// Sets a parameter of this name as others do.
  bool set_parameter(const std::string& name, rcl_interfaces::msg::ParameterValue value);

  PlayerConfig config_;
  std::mutex mutex_;
  std::condition_variable changed_;
  // Under mutex_: the log was at `from_` when the clock said `since_`.
  Duration from_;
  Clock::time_point since_;
  double rate_ = 1.0;
  bool paused_ = false;
  bool over_ = false;
  bool stopped_ = true;
  bool is_stepping_ = false;        ///< the playing thread publishes, without mutex_
  int controls_ = 0;                ///< wait for the playing thread, which lets them go first
  std::unique_ptr<Source> source_;  ///< under mutex_, or by who set is_stepping_
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
  std::unique_lock<std::mutex> lock_;
};

}  // namespace strata::player
