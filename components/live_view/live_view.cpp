// SPDX-License-Identifier: Apache-2.0
#include "components/live_view/live_view.hpp"

#include <chrono>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "components/bus/service.hpp"
#include "components/bus/site_service_types.hpp"
#include "components/live_view/page.hpp"
#include "core/base/error.hpp"

namespace strata::live_view {
namespace {

constexpr auto kServicePatience = std::chrono::seconds(3);
constexpr auto kSavePatience = std::chrono::seconds(10);
/// All files of a version are read before it is approved or activated.
constexpr auto kSitePatience = std::chrono::seconds(20);
/// Statuses that may: one a second of each component, and all at once when a robot starts.
constexpr int kStatusDepth = 200;

/// Throws Error when nobody answers in time.
template <typename S>
typename bus::ServiceType<S>::Response called(
    const std::shared_ptr<bus::Participant>& participant, const std::string& service,
    std::chrono::seconds patience = kServicePatience,
    const typename bus::ServiceType<S>::Request& request = {}) {
  auto response = bus::call_service<S>(participant, service, request, patience);
  if (!response) {
    throw Error(service, "nobody has answered in time", "see whether who offers it runs");
  }
  return *response;
}

/// The response's bytes. Throws what is said where it was refused.
template <typename S>
std::vector<std::uint8_t> decided(const std::shared_ptr<bus::Participant>& participant,
                                  const ViewCommand& command) {
  const auto request = convert::from_cdr<typename bus::ServiceType<S>::Request>(
      command.cdr, "a viewer's " + command.service);
  const auto response = called<S>(participant, command.service, kSitePatience, request);
  if (!response.success()) throw std::runtime_error(response.message());
  return convert::to_cdr(response);
}

}  // namespace

void LiveView::on_configure() {
  config_ = read_parameters<LiveViewConfig>();
  if (lockstep()) return;
  CommandNames commands;
  if (config_.allow_commands) {
    saver_ = config_.save_service.empty() ? "" : resolve(config_.save_service);
    commands = {resolve(config_.initial_pose_topic), resolve(config_.relocalize_service), saver_};
    publish_pose_ = advertise<geometry_msgs::msg::PoseWithCovarianceStamped>(
        config_.initial_pose_topic, "default");
  }
  if (context().dry_run) return;
  const auto max_viewers = static_cast<std::size_t>(config_.max_viewers);
  hub_ = std::make_shared<ViewHub>("strata " + full_name(), commands, max_viewers);
  WebServerOptions options;
  options.address = config_.address;
  options.port = static_cast<std::uint16_t>(config_.port);
  options.rules = {config_.token, config_.origins};
  if (!config_.certificate.empty()) {
    options.tls = TlsFiles{config_.certificate, config_.private_key};
  }
  options.page = page();
  if (config_.metrics) options.metrics = gather_metrics();
  try {
    server_ = std::make_unique<WebServer>(options, hub_, max_viewers);
  } catch (const ConfigError& error) {
    throw ConfigError(full_name() + ": " + error.place(), error.problem(), error.remedy());
  }
  say(runtime::LogLevel::kInfo, "the live view is at " + server_->url());
}

MetricsSource LiveView::gather_metrics() {
  const auto board = std::make_shared<StatusBoard>();
  subscribe<diagnostic_msgs::msg::DiagnosticArray>(
      runtime::kDiagnosticsTopic, "default",
      [board](const auto& array) { board->take(array, StatusBoard::Clock::now()); },
      {.min_waiting = kStatusDepth});
  return [board](std::string_view accept) {
    MetricText metrics;
    board->write(metrics, StatusBoard::Clock::now());
    write_process(metrics);
    const MetricFormat format = format_for(accept);
    return WebText{std::string(content_type(format)), metrics.text(format)};
  };
}

void LiveView::on_tick() {
  if (!hub_) return;
  offer_topics();
  if (!saver_.empty() && context().participant->is_answered(saver_)) {
    saver_.clear();
    hub_->offer_save();
  }
  read_what_is_wanted();
  for (const ViewCommand& command : hub_->take_commands()) {
    guarded([&] { perform(command); });
  }
}

void LiveView::perform(const ViewCommand& command) {
  switch (command.kind) {
    case ViewCommand::Kind::kRelocalize:
      return call_for(command, [participant = context().participant,
                                service = resolve(config_.relocalize_service)] {
        return convert::to_cdr(called<bus::srv::Empty>(participant, service));
      });
    case ViewCommand::Kind::kSaveMaps:
      return call_for(
          command, [participant = context().participant, service = resolve(config_.save_service)] {
            const auto response = called<bus::srv::Trigger>(participant, service, kSavePatience);
            if (!response.success()) {
              throw Error(service, response.message(), "see what the robot says");
            }
            return convert::to_cdr(response);
          });
    case ViewCommand::Kind::kApproveVersion:
    case ViewCommand::Kind::kActivateVersion:
    case ViewCommand::Kind::kRollBack:
    case ViewCommand::Kind::kVersionMap:
    case ViewCommand::Kind::kSetLevel:
      return decide_on_site(command);
    case ViewCommand::Kind::kSetPose:
      // Decoded, so that what is no pose goes no further.
      publish_pose_(convert::from_cdr<geometry_msgs::msg::PoseWithCovarianceStamped>(
          command.cdr, "a viewer's " + config_.initial_pose_topic));
  }
}

void LiveView::decide_on_site(const ViewCommand& command) {
  call_for(command, [participant = context().participant, command] {
    switch (command.kind) {
      case ViewCommand::Kind::kApproveVersion:
        return decided<bus::srv::ApproveSiteVersion>(participant, command);
      case ViewCommand::Kind::kActivateVersion:
        return decided<bus::srv::ActivateSiteVersion>(participant, command);
      case ViewCommand::Kind::kRollBack:
        return decided<bus::srv::RollBackSite>(participant, command);
      case ViewCommand::Kind::kSetLevel:
        return decided<bus::srv::SetSiteLevel>(participant, command);
      default:
        return decided<bus::srv::GetSiteVersionMap>(participant, command);
    }
  });
}

void LiveView::call_for(const ViewCommand& command,
                        std::function<std::vector<std::uint8_t>()> call) {
  if (is_calling_.exchange(true)) {
    hub_->answer(command, "a call is under way", {});
    return;
  }
  // On a thread of its own: who answers may be in this process, on this very thread.
  const auto work = [this, command, hub = hub_, call = std::move(call)] {
    try {
      hub->answer(command, "", call());
    } catch (const std::exception& error) {
      hub->answer(command, error.what(), {});
    }
    is_calling_ = false;
  };
  try {
    call_ = std::jthread(work);
  } catch (const std::system_error&) {
    is_calling_ = false;
    throw;
  }
}

void LiveView::on_cleanup() {
  server_.reset();
  if (call_.joinable()) call_.join();
  hub_.reset();
  offered_.clear();
  left_out_ = 0;
  unreadable_.clear();
  has_site_ = false;
  has_levels_ = false;
  saver_.clear();
  publish_pose_ = nullptr;
}

void LiveView::on_diagnose(runtime::Health& health) const {
  if (!server_) return;
  const ViewHub::Counts counts = hub_->counts();
  unreadable_.tell(health);
  if (left_out_ > 0) {
    health.warn(std::to_string(left_out_) + " topics are not shown: max_topics are there already");
  }
  health.add("url", server_->url());
  health.add("viewers", std::uint64_t{counts.viewers});
  health.add("messages_sent", counts.sent);
  health.add("messages_left_out", counts.dropped);
  health.add("requests_refused", counts.refused);
}

}  // namespace strata::live_view
