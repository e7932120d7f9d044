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

/// Live only: in lockstep `strata replay` plays. Its controls may be called from any thread.
class Player final : public runtime::Component {
 public:
  using Component::Component;
  ~Player() override;

  void pause();
  void resume();
  /// Throws ConfigError for a rate that is not positive.
  void set_rate(double rate);
  /// Goes on from that time since the beginning of the log; behind its end it is over.
  void seek(Duration since_begin);
  [[nodiscard]] bool is_paused() const;
  /// Everything was played, and loop is off.
  [[nodiscard]] bool is_over() const;

 private:
  using Clock = std::chrono::steady_clock;

  void on_configure() override;
  void on_activate() override;
  void on_deactivate() override;
  [[nodiscard]] std::unique_ptr<Source> make_source();
  void play();
  bool play_next(std::unique_lock<std::mutex>& lock);
  /// The place of the log that now is; under mutex_.
  [[nodiscard]] Duration position(Clock::time_point now) const;
  void restart_clock(Duration position);
  void stop();

  PlayerConfig config_;
  std::unique_ptr<Source> source_;  // used by the playing thread only, once that runs
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Under mutex_: the log was at `from_` when the clock said `since_`.
  Duration from_;
  Clock::time_point since_;
  double rate_ = 1.0;
  bool paused_ = false;
  bool over_ = false;
  bool stopped_ = false;
  std::optional<Duration> wanted_;  ///< by seek
  std::thread thread_;
};

}  // namespace strata::player
