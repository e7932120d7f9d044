// SPDX-License-Identifier: Apache-2.0
/// How others control the player: the services of rosbag2's player, and parameters.
#include <algorithm>
#include <utility>

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
  keep_live<PlayerConfig>({"rate", "paused"}, [this](const PlayerConfig& config) {
    set_rate(config.rate);
    set_paused(config.paused);
  });
  using namespace rosbag2_interfaces::srv;  // NOLINT: the names below would be all there is to read
  offer<bus::srv::Pause>("~/pause", [this](const auto&) {
    set_parameter("paused", parameter_value(true));
    return Pause_Response();
  });
  offer<bus::srv::Resume>("~/resume", [this](const auto&) {
    set_parameter("paused", parameter_value(false));
    return Resume_Response();
  });
  offer<bus::srv::TogglePaused>("~/toggle_paused", [this](const auto&) {
    set_parameter("paused", parameter_value(!is_paused()));
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
    response.rate(rate_);
    return response;
  });
  offer<bus::srv::SetRate>("~/set_rate", [this](const auto& request) {
    SetRate_Response response;
    response.success(set_parameter("rate", parameter_value(request.rate())));
    return response;
  });
  offer<bus::srv::Seek>("~/seek", [this](const auto& request) {
    Seek_Response response;
    response.success(seek(convert::from_message(request.time())));
    return response;
  });
  offer<bus::srv::PlayNext>("~/play_next", [this](const auto&) {
    PlayNext_Response response;
    response.success(play_next());
    return response;
  });
}

bool Player::set_parameter(const std::string& name, rcl_interfaces::msg::ParameterValue value) {
  rcl_interfaces::msg::Parameter parameter;
  parameter.name(name);
  parameter.value(std::move(value));
  return set_parameters({parameter}).ok;
}

void Player::set_paused(bool paused) {
  const Control control(*this);
  restart_clock(position(Clock::now()));
  paused_ = paused;
}

void Player::set_rate(double rate) {
  const Control control(*this);
  restart_clock(position(Clock::now()));
  rate_ = rate;
}

bool Player::seek(Stamp time) {
  const Control control(*this);
  const auto begin = source_->begin();
  if (!begin) return false;
  const Duration place = std::max(time - *begin, Duration{});
  if (!source_->seek(place)) return false;
  restart_clock(place);
  over_ = false;
  return true;
}

bool Player::play_next() {
  const Control control(*this);
  if (!paused_ || stopped_) return false;
  Duration due;
  if (!source_->peek(due)) {
    if (!config_.loop || !source_->seek({}) || !source_->peek(due)) return false;
  }
  source_->step();
  restart_clock(due);
  return true;
}

bool Player::is_paused() {
  const Control control(*this);
  return paused_;
}

}  // namespace strata::player
