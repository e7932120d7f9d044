// SPDX-License-Identifier: Apache-2.0
/// strata::LiveView: topics in, a page in the browser and Foxglove's protocol out.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "components/bus/second_reader.hpp"
#include "components/live_view/config.hpp"
#include "components/live_view/status_board.hpp"
#include "components/live_view/view_hub.hpp"
#include "components/live_view/web_server.hpp"
#include "components/runtime/component.hpp"
#include "components/runtime/unreadable_topics.hpp"

namespace strata::live_view {

/// Offers every topic of the domain whose type is known here to viewers, message by message as the
/// bytes they came in; a topic is read from when the first viewer wants it until nobody publishes
/// it any more (LiveViewConfig: forget_after_s, max_topics). Reads latched topics reliably, others
/// best-effort: no writer waits for it. Out, for viewers: initialpose; and it calls
/// reinitialize_global_localization, the mapper's save, and what decides on the site of the first
/// component that tells of one (site_versions), or on the level of a building (level). What all
/// components say on /diagnostics, which it reads from the start, it answers as metrics at
/// /metrics. In lockstep it does nothing.
class LiveView final : public runtime::Component {
 public:
  using Component::Component;

 private:
  void on_declare() override { declare_parameters<LiveViewConfig>(); }
  void on_configure() override;
  void on_tick() override;
  void on_cleanup() override;
  void on_diagnose(runtime::Health& health) const override;
  /// Reads /diagnostics and says how its figures are answered.
  [[nodiscard]] MetricsSource gather_metrics();
  // (live_view_topics.cpp)
  using Topics = std::map<std::string, bus::PublishedTopic>;
  void offer_topics();
  void forget_topics(const Topics& published);
  void forget_writers();
  [[nodiscard]] bool has_room();
  void offer(const std::string& topic, const bus::PublishedTopic& published);
  void read_what_is_wanted();
  void give(std::uint32_t channel, const bus::RawMessage& message);
  void read_others(const std::string& topic, const bus::PublishedTopic& published);
  void perform(const ViewCommand& command);
  void decide_on_site(const ViewCommand& command);
  /// Calls a service of the robot on a thread of its own, and answers the viewer. call: returns the
  /// response; throws Error to fail.
  void call_for(const ViewCommand& command, std::function<std::vector<std::uint8_t>()> call);

  using Clock = std::chrono::steady_clock;
  struct Offered {
    std::string type;
    std::uint32_t channel = 0;  ///< 0: of a type not known
    bool latched = false;
    bool is_read = false;
    std::optional<bus::SecondReader> second = {};      ///< once it is read, of later writers
    std::optional<Clock::time_point> gone_since = {};  ///< nobody has published it since
  };
  void give_up(std::map<std::string, Offered>::iterator topic);

  LiveViewConfig config_;
  std::shared_ptr<ViewHub> hub_;
  std::map<std::string, Offered> offered_;  ///< by topic
  std::size_t left_out_ = 0;                ///< topics that there was no room for at the last tick
  Clock::time_point writers_looked_at_;
  runtime::UnreadableTopics unreadable_{[this](const std::string& line) { tell_line(line); }};
  bool has_site_ = false;
  bool has_levels_ = false;
  std::string saver_;  ///< the service that saves maps, until somebody answers it; full
  std::function<void(const geometry_msgs::msg::PoseWithCovarianceStamped&)> publish_pose_;
  std::atomic<bool> is_calling_{false};
  std::jthread call_;                  // waits for a service's answer, so that nothing else does
  std::unique_ptr<WebServer> server_;  // last: its thread uses the hub
};

}  // namespace strata::live_view
