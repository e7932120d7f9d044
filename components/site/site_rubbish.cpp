// SPDX-License-Identifier: Apache-2.0
// What a site gives up.
#include <algorithm>
#include <system_error>

#include "components/site/site_change.hpp"

namespace fs = std::filesystem;

namespace strata::site {

/// Of programs that were killed while they added or removed one: ".HASH.partial-PID".
void Site::remove_left_overs() const {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_ / kVersions, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with('.')) {
      log::remove_left_over(folder_ / kVersions / name.substr(1, kHashDigits));
    }
  }
}

std::vector<VersionStatus> Site::remove_rubbish(const Rubbish& rubbish, const Actor& actor) {
  Change change(*this);
  Decisions& decisions = change.decisions;
  const std::vector<VersionStatus> all = versions(decisions);
  const auto& order = decisions.activations;
  int active_number = 0;
  const auto founding = std::find_if(all.begin(), all.end(), [](const VersionStatus& status) {
    return status.decision.was_active && status.fault.empty();
  });
  for (const VersionStatus& status : all) {
    if (status.state == VersionState::kActive) active_number = status.version.number;
  }
  std::vector<VersionStatus> gone;
  for (const VersionStatus& status : all) {
    const std::string& hash = status.version.hash;
    const auto place = std::find(order.rbegin(), order.rend(), hash);
    // One that was rolled back from is not in the order, and stays to be looked at.
    const bool was_replaced = place != order.rend();
    const bool is_recent =
        was_replaced && static_cast<std::size_t>(place - order.rbegin()) <= rubbish.keep_retired;
    const bool may_go =
        status.state == VersionState::kCandidate || status.state == VersionState::kRetired;
    const bool is_first = founding != all.end() && hash == founding->version.hash;
    const bool is_old =
        may_go && !is_recent && !is_first && status.fault.empty() &&
        (was_replaced || (!rubbish.replaced_only && status.version.number < active_number));
    const bool is_bad = rubbish.damaged && !fault_of(hash).empty();
    if ((is_old || is_bad) && status.state != VersionState::kActive) gone.push_back(status);
  }
  if (rubbish.dry_run) return gone;
  std::vector<fs::path> hidden;
  for (const VersionStatus& status : gone) {
    const std::string& hash = status.version.hash;
    hidden.push_back(log::staged_name(folder_ / kVersions / hash));
    disk_->rename(folder_ / kVersions / hash, hidden.back());
    std::erase(decisions.activations, hash);
    decisions.versions.erase(hash);
    add_event(decisions, "gc", hash, actor, "");
  }
  if (!gone.empty()) change.commit();
  for (const fs::path& folder : hidden) disk_->remove(folder);
  remove_left_overs();
  return gone;
}

}  // namespace strata::site
