// SPDX-License-Identifier: Apache-2.0
/// strata::Player: a log in; clock, tf, odometry and scans out, at the pace of the log.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>

#include "components/player/config.hpp"
#include "components/player/log_player.hpp"
#include "components/runtime/component.hpp"

namespace strata::player {

/// Live only: in lockstep `strata replay` plays.
class Player final : public runtime::Component {
 public:
  using Component::Component;
  ~Player() override;

 private:
  void on_configure() override;
  void on_activate() override;
  void on_deactivate() override;
  void play();
  void stop();

  PlayerConfig config_;
  std::unique_ptr<LogPlayer> player_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopped_ = false;
  std::thread thread_;
};

}  // namespace strata::player
