// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/site_desk.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <exception>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "components/log/content_hash.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::localizer {
namespace {

using namespace bus::srv;  // NOLINT: the names below would be all there is to read

/// Another program that changes the site is done within this, or the request is refused.
constexpr auto kLockPatience = std::chrono::seconds(5);
constexpr auto kLockPeriod = std::chrono::milliseconds(50);
/// Of what others say for the diary.
constexpr std::size_t kMaxWords = 200;

/// One line of printable UTF-8, whatever came.
std::string words_of(const std::string& text) {
  using nlohmann::json;
  std::string words = text.substr(0, kMaxWords);
  std::replace_if(
      words.begin(), words.end(),
      [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, ' ');
  return json::parse(json(words).dump(-1, ' ', false, json::error_handler_t::replace));
}

std::int64_t unix_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// Another text for another content, as far as the file system tells.
std::string state_of(const fs::path& file) {
  struct stat state {};
  if (stat(file.c_str(), &state) != 0) return "none";
  return std::to_string(state.st_mtim.tv_sec) + "." + std::to_string(state.st_mtim.tv_nsec) + " " +
         std::to_string(state.st_size) + " " + std::to_string(state.st_ino);
}

/// "version 3 (3f2a...)".
std::string name_of(const site::VersionStatus& status) {
  return "version " + std::to_string(status.version.number) + " (" +
         log::short_hash(status.version.hash) + ")";
}

strata_msgs::msg::SiteVersion to_message(const site::VersionStatus& status) {
  strata_msgs::msg::SiteVersion message;
  message.hash(status.version.hash);
  message.number(status.version.number);
  message.state(site::name_of(status.state));
  message.made(convert::to_message(Stamp{status.version.made.at_ns}));
  message.made_by(status.version.made.by);
  message.note(status.version.note);
  if (status.decision.approved) message.approved_by(status.decision.approved->by);
  message.approval_note(status.decision.approval_note);
  message.fault(status.fault);
  return message;
}

strata_msgs::msg::SiteVersions to_message(const site::Site& site) {
  strata_msgs::msg::SiteVersions message;
  const site::Decisions decisions = site.decisions();
  message.header(convert::make_header(Stamp{unix_ns()}, decisions.frame));
  message.site(decisions.id);
  const auto& order = decisions.activations;
  if (order.size() > 1) message.previous(order[order.size() - 2]);
  for (const site::VersionStatus& status : site.versions()) {
    message.versions().push_back(to_message(status));
  }
  return message;
}

template <typename Response>
Response done(const std::string& what) {
  Response response;
  response.success(true);
  response.message(what);
  return response;
}

}  // namespace

SiteDesk::SiteDesk(fs::path folder, std::string name, bool changes, Tell tell)
    : folder_(std::move(folder)),
      name_(std::move(name)),
      changes_(changes),
      tell_(std::move(tell)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

SiteDesk::~SiteDesk() {
  ending_.request_stop();
  thread_.request_stop();
  thread_.join();
  for (const Job& job : waiting_) job.refuse("the component is being shut down; ask again");
}

void SiteDesk::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return !waiting_.empty(); }) &&
         !stop.stop_requested()) {
    const Job job = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    try {
      job.work();
    } catch (const std::exception& error) {
      job.refuse(error.what());
    }
    lock.lock();
  }
}

void SiteDesk::move_to(fs::path folder) {
  const std::lock_guard lock(mutex_);
  if (folder == folder_) return;
  folder_ = std::move(folder);
  is_untold_ = true;
}

site::Site SiteDesk::open() {
  fs::path folder;
  {
    const std::lock_guard lock(mutex_);
    folder = folder_;
  }
  site::Site site(folder);
  const auto until = std::chrono::steady_clock::now() + kLockPatience;
  site.wait_with([this, until, folder](const std::string& holder) {
    if (ending_.stop_requested()) return false;
    if (std::chrono::steady_clock::now() > until) {
      throw OutputError(folder.string(), holder + " is changing it", "ask again when that is done");
    }
    std::this_thread::sleep_for(kLockPeriod);
    return true;
  });
  return site;
}

site::Actor SiteDesk::actor(const std::string& by) const {
  const std::string who = words_of(by);
  return {(who.empty() ? "somebody" : who) + " over " + name_, unix_ns()};
}

template <typename S>
void SiteDesk::enqueue(Work<S> work, Reply<S> reply) {
  Job job;
  job.refuse = [reply](const std::string& why) {
    typename bus::ServiceType<S>::Response response;
    response.success(false);
    response.message(why);
    reply(response);
  };
  job.work = [this, work = std::move(work), reply] {
    site::Site site = open();
    reply(work(site));
  };
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() < kMaxWaiting) {
      waiting_.push_back(std::move(job));
      changed_.notify_one();
      return;
    }
  }
  job.refuse(name_ + ": too many requests wait; ask again");
}

template <typename S>
void SiteDesk::enqueue_change(Work<S> work, Reply<S> reply) {
  if (changes_) return enqueue<S>(std::move(work), std::move(reply));
  typename bus::ServiceType<S>::Response response;
  response.message(name_ +
                   ": takes no decisions on its site; use `strata site` where the folder is, or "
                   "set site_changes");
  reply(response);
}

void SiteDesk::look() {
  std::error_code error;
  const fs::path active = fs::read_symlink(folder_ / site::kActiveLink, error);
  std::string now = state_of(folder_ / site::kSiteFile) + " " + active.string() + " " +
                    state_of(folder_ / site::kZonesFile);
  if (now == seen_ && !is_untold_) return;
  const std::lock_guard lock(mutex_);
  if (waiting_.size() >= kMaxWaiting) return;  // at the next look
  seen_ = std::move(now);
  is_untold_ = false;
  waiting_.push_back({[this] {
                        const site::Site site = open();
                        tell_(to_message(site));
                        if (watch_) watch_(site);
                      },
                      [this](const std::string&) { is_untold_ = true; }});
  changed_.notify_one();
}

void SiteDesk::list(Reply<ListSiteVersions> reply) {
  enqueue<ListSiteVersions>(
      [](site::Site& site) {
        auto response = done<strata_msgs::srv::ListSiteVersions_Response>("");
        response.site(to_message(site));
        return response;
      },
      std::move(reply));
}

void SiteDesk::approve(const Request<ApproveSiteVersion>& request,
                       Reply<ApproveSiteVersion> reply) {
  enqueue_change<ApproveSiteVersion>(
      [this, request](site::Site& site) {
        if (!request.unchecked()) {
          throw InputError(name_, "replays no recordings, and does not approve without being told",
                           "use `strata site approve`, or ask with unchecked: true");
        }
        const site::VersionStatus version = site.find(request.version());
        std::string note = words_of(request.note());
        note += note.empty() ? "unchecked" : "; unchecked";
        site.approve(version.version.hash, actor(request.by()), note);
        return done<strata_msgs::srv::ApproveSiteVersion_Response>(name_of(version) +
                                                                   " is approved");
      },
      std::move(reply));
}

void SiteDesk::activate(const Request<ActivateSiteVersion>& request,
                        Reply<ActivateSiteVersion> reply) {
  enqueue_change<ActivateSiteVersion>(
      [this, request](site::Site& site) {
        const site::VersionStatus version = site.find(request.version());
        (void)site.activate(version.version.hash, actor(request.by()));
        return done<strata_msgs::srv::ActivateSiteVersion_Response>(name_of(version) +
                                                                    " is active");
      },
      std::move(reply));
}

void SiteDesk::roll_back(const Request<RollBackSite>& request, Reply<RollBackSite> reply) {
  enqueue_change<RollBackSite>(
      [this, request](site::Site& site) {
        const std::string active =
            request.active().empty() ? "" : site.find(request.active()).version.hash;
        const site::Switch made = site.rollback(actor(request.by()), active);
        return done<strata_msgs::srv::RollBackSite_Response>(name_of(site.find(made.to)) +
                                                             " is active again");
      },
      std::move(reply));
}

void SiteDesk::map_of(const Request<GetSiteVersionMap>& request, Reply<GetSiteVersionMap> reply) {
  enqueue<GetSiteVersionMap>(
      [request](site::Site& site) {
        const site::VersionStatus version = site.find(request.version());
        const memory::Store store = maps::open_for_reading(site.maps_of(version.version.hash));
        auto response = done<strata_msgs::srv::GetSiteVersionMap_Response>(name_of(version));
        response.occupancy(convert::to_occupancy(store.load_reflection_grid("filtered"),
                                                 Stamp{version.version.made.at_ns},
                                                 version.version.frame));
        return response;
      },
      std::move(reply));
}

}  // namespace strata::localizer
