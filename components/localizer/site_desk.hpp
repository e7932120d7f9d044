// SPDX-License-Identifier: Apache-2.0
/// The site that a robot's maps come from, for those who ask over the bus: what versions it has,
/// and decisions on them.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>

#include "strata_idl/strata_msgs_site.h"

#include "components/bus/site_service_types.hpp"
#include "components/site/site.hpp"

namespace strata::localizer {

/// Works on a thread of its own, one request after the other, so that a robot that drives never
/// waits for a disk. Each request is answered once, on that thread or at once: without success
/// `message` says why, and nothing was changed. At most kMaxWaiting wait; more are refused, and so
/// are those that wait when it ends. Who decides is written into the site's diary.
class SiteDesk {
 public:
  template <typename S>
  using Request = typename bus::ServiceType<S>::Request;
  template <typename S>
  using Reply = std::function<void(const typename bus::ServiceType<S>::Response&)>;
  /// Told what there is, on the desk's thread.
  using Tell = std::function<void(const strata_msgs::msg::SiteVersions&)>;

  static constexpr std::size_t kMaxWaiting = 8;

  /// folder: of a site. name: of whose desk it is, for the diary. changes: whether approvals,
  /// activations and rollbacks are taken.
  SiteDesk(std::filesystem::path folder, std::string name, bool changes, Tell tell);
  ~SiteDesk();
  SiteDesk(const SiteDesk&) = delete;
  SiteDesk& operator=(const SiteDesk&) = delete;

  /// Called on the desk's thread after `tell`, with the site. To be set before the first look.
  void watch_with(std::function<void(const site::Site&)> watch) { watch_ = std::move(watch); }
  /// Another site from the next request and look on: a level's.
  void move_to(std::filesystem::path folder);
  /// Has `tell` called when the site or its zones has changed since the last look, by whomever, and
  /// at the first one. Three looks at files; returns at once.
  void look();
  void list(Reply<bus::srv::ListSiteVersions> reply);
  /// As `strata site approve --unchecked`: the gate is not asked.
  void approve(const Request<bus::srv::ApproveSiteVersion>& request,
               Reply<bus::srv::ApproveSiteVersion> reply);
  void activate(const Request<bus::srv::ActivateSiteVersion>& request,
                Reply<bus::srv::ActivateSiteVersion> reply);
  void roll_back(const Request<bus::srv::RollBackSite>& request,
                 Reply<bus::srv::RollBackSite> reply);
  /// The filtered map of a version.
  void map_of(const Request<bus::srv::GetSiteVersionMap>& request,
              Reply<bus::srv::GetSiteVersionMap> reply);

 private:
  /// What is done with the site; the argument is open, and waits for others for some seconds.
  template <typename S>
  using Work = std::function<typename bus::ServiceType<S>::Response(site::Site&)>;
  template <typename S>
  void enqueue(Work<S> work, Reply<S> reply);
  template <typename S>
  void enqueue_change(Work<S> work, Reply<S> reply);
  [[nodiscard]] site::Site open();
  [[nodiscard]] site::Actor actor(const std::string& by) const;
  void run(const std::stop_token& stop);

  struct Job {
    std::function<void()> work;
    std::function<void(const std::string&)> refuse;
  };

  std::filesystem::path folder_;  // written under mutex_ by the thread that looks
  std::string name_;
  bool changes_;
  Tell tell_;
  std::function<void(const site::Site&)> watch_;
  std::string seen_;                    ///< what the last look saw
  std::atomic<bool> is_untold_{false};  // what it saw could not be told: another one is due
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Job> waiting_;  // under mutex_
  std::stop_source ending_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace strata::localizer
