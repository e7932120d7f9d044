// SPDX-License-Identifier: Apache-2.0
/// How others control the player: the services of rosbag2's player, and parameters.
#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>
#include <vector>

#include "components/bus/bag_service_types.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/player/player.hpp"

namespace strata::player {

using runtime::parameter_value;

Player::Control::Control(Player& player) : player_(player), lock_(player.mutex_) {
  ++player_.controls_;
  player_.changed_.wait(lock_, [this] { return !player_.is_stepping_; });
}

Player::Control::~Control() {
  --player_.controls_;
  player_.changed_.notify_all();
}

/// What a parameter says too goes through the parameter, so that both always say the same.
void Player::serve() {
  const auto set = [this](const char* name, rcl_interfaces::msg::ParameterValue value) {
    return set_parameters({runtime::parameter(name, std::move(value))}).ok;
  };
  keep_live<PlayerConfig>({"rate", "paused"}, [this](const PlayerConfig& config) {
    set_rate(config.rate);
    set_paused(config.paused);
  });
  using namespace rosbag2_interfaces::srv;  // NOLINT: the names below would be all there is to read
  offer<bus::srv::Pause>("~/pause", [set](const auto&) {
    set("paused", parameter_value(true));
    return Pause_Response();
  });
  offer<bus::srv::Resume>("~/resume", [set](const auto&) {
    set("paused", parameter_value(false));
    return Resume_Response();
  });
  offer<bus::srv::TogglePaused>("~/toggle_paused", [this, set](const auto&) {
    set("paused", parameter_value(!is_paused()));
    return TogglePaused_Response();
  });
  offer<bus::srv::IsPaused>("~/is_paused", [this](const auto&) {
    IsPaused_Response response;
    response.paused(is_paused());
    return response;
  });
  offer<bus::srv::GetRate>("~/get_rate", [this](const auto&) {
    GetRate_Response response;
    const Control control(*this);
    response.rate(clock_.rate());
    return response;
  });
  offer<bus::srv::SetRate>("~/set_rate", [set](const auto& request) {
    SetRate_Response response;
    response.success(set("rate", parameter_value(request.rate())));
    return response;
  });
  offer_later<bus::srv::Seek>("~/seek", [this](const auto& request, auto reply) {
    give({convert::from_message(request.time()), [reply = std::move(reply)](bool is_done) {
            Seek_Response response;
            response.success(is_done);
            reply(response);
          }});
  });
  offer_later<bus::srv::PlayNext>("~/play_next", [this](const auto&, auto reply) {
    give({std::nullopt, [reply = std::move(reply)](bool is_done) {
            PlayNext_Response response;
            response.success(is_done);
            reply(response);
          }});
  });
}

void Player::give(Order order) {
  std::vector<Order> outdone;
  {
    const std::lock_guard lock(mutex_);
    if (order.seek) {
      const auto kept = std::stable_partition(orders_.begin(), orders_.end(),
                                              [](const Order& waits) { return !waits.seek; });
      std::move(kept, orders_.end(), std::back_inserter(outdone));
      orders_.erase(kept, orders_.end());
    }
    orders_.push_back(std::move(order));
  }
  changed_.notify_all();
  for (const Order& waited : outdone) guarded([&] { waited.answer(false); });
}

void Player::set_paused(bool paused) {
  const Control control(*this);
  paused_ = paused;
  clock_.run(!paused_ && !stopped_, std::chrono::steady_clock::now());
}

void Player::set_rate(double rate) {
  const Control control(*this);
  clock_.set_rate(rate, std::chrono::steady_clock::now());
}

void Player::set_stopped(bool stopped) {
  const Control control(*this);
  stopped_ = stopped;
  over_ = false;  // what could not be played is tried again
  clock_.run(!paused_ && !stopped_, std::chrono::steady_clock::now());
}

bool Player::is_paused() {
  const Control control(*this);
  return paused_;
}

}  // namespace strata::player
