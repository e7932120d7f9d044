// SPDX-License-Identifier: Apache-2.0
#include "components/fleet_member/local_visits.hpp"

#include <utility>

#include <sys/stat.h>

#include "components/fleet/visits.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/site/site.hpp"
#include "core/base/error.hpp"

namespace strata::fleet_member {

LocalVisits::LocalVisits(std::vector<std::filesystem::path> maps, std::filesystem::path site)
    : maps_(std::move(maps)) {
  if (!site.empty()) active_ = std::move(site) / site::kActiveLink;
}

LocalVisits::State LocalVisits::state_of(const std::filesystem::path& maps) {
  struct stat found {};
  if (stat((maps / maps::kStoreFile).c_str(), &found) != 0) return {};
  return {found.st_ino, found.st_mtim.tv_sec * 1'000'000'000 + found.st_mtim.tv_nsec,
          static_cast<std::uint64_t>(found.st_size)};
}

void LocalVisits::look_at(const std::filesystem::path& maps) {
  const State state = state_of(maps);  // before they are read: what comes meanwhile is seen later
  const auto known = folders_.find(maps);
  if (known != folders_.end() && known->second.state == state) return;
  if (state == State{}) {
    folders_.erase(maps);
    return;
  }
  try {
    folders_[maps] = {state, fleet::run_hashes(maps)};
  } catch (const Error&) {
    // Half-written or damaged: a push says what is wrong with it.
  }
}

void LocalVisits::look() {
  for (const auto& maps : maps_) look_at(maps);
  if (active_.empty()) return;
  look_at(active_);
  if (const auto found = folders_.find(active_); found != folders_.end()) {
    there_.insert(found->second.hashes.begin(), found->second.hashes.end());
  }
}

std::size_t LocalVisits::waiting() const {
  std::set<std::string> waiting;
  for (const auto& maps : maps_) {
    const auto found = folders_.find(maps);
    if (found == folders_.end()) continue;
    for (const std::string& hash : found->second.hashes) {
      if (!there_.contains(hash)) waiting.insert(hash);
    }
  }
  return waiting.size();
}

bool LocalVisits::is_to_push(const std::filesystem::path& maps) const {
  const State now = state_of(maps);
  if (now == State{}) return false;
  const auto pushed = pushed_.find(maps);
  return pushed == pushed_.end() || pushed->second != now;
}

void LocalVisits::is_pushed(const std::filesystem::path& maps) {
  const auto found = folders_.find(maps);
  if (found != folders_.end()) pushed_[maps] = found->second.state;
}

}  // namespace strata::fleet_member
