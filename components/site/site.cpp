// SPDX-License-Identifier: Apache-2.0
#include "components/site/site.hpp"

#include <algorithm>
#include <system_error>
#include <tuple>
#include <utility>

#include "components/log/content_hash.hpp"
#include "components/log/folder_name.hpp"
#include "components/log/whole_file.hpp"
#include "components/site/site_change.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::site {
namespace {

bool is_hash(const std::string& text) {
  return text.size() == kHashDigits &&
         text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

}  // namespace

Site::Site(const fs::path& folder, const log::Disk& disk)
    : disk_(&disk),
      folder_(log::without_slash(folder)),
      wait_([](const std::string&) { return true; }) {
  if (folder_.empty()) throw InputError("SITE", "is an empty name", "name the folder of a site");
  (void)read_decisions(folder_ / kSiteFile);
}

Decisions Site::decisions() const {
  Decisions decisions = read_decisions(folder_ / kSiteFile);
  decisions.agree_with(active());
  std::erase_if(decisions.activations, [&](const std::string& hash) {
    std::error_code error;
    return hash != active() && !fs::exists(folder_ / kVersions / hash, error);
  });
  return decisions;
}

std::optional<std::string> Site::active() const {
  std::error_code error;
  const fs::path target = fs::read_symlink(folder_ / kActiveLink, error);
  if (error) return std::nullopt;
  const std::string hash = target.parent_path().filename().string();
  if (!is_hash(hash)) return std::nullopt;
  return hash;
}

fs::path Site::maps_of(const std::string& hash) const { return folder_ / kVersions / hash / kMaps; }

VersionStatus Site::status_of(const std::string& hash, const Decisions& decisions,
                              const std::optional<std::string>& active) const {
  VersionStatus status;
  try {
    status.version = read_version(folder_ / kVersions / hash / kVersionFile);
    if (status.version.hash != hash) status.fault = "version.json is another version's";
  } catch (const InputError& error) {
    status.fault = error.problem();
  }
  status.version.hash = hash;
  const auto found = decisions.versions.find(hash);
  if (found != decisions.versions.end()) status.decision = found->second;
  if (active == hash) {
    status.state = VersionState::kActive;
  } else if (status.decision.was_active) {
    status.state = VersionState::kRetired;
  } else if (status.decision.approved) {
    status.state = VersionState::kApproved;
  }
  return status;
}

std::vector<VersionStatus> Site::versions() const { return versions(decisions()); }

std::vector<VersionStatus> Site::versions(const Decisions& decisions) const {
  const std::optional<std::string> now = active();
  std::vector<VersionStatus> all;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_ / kVersions, error)) {
    const std::string name = entry.path().filename().string();
    if (is_hash(name)) all.push_back(status_of(name, decisions, now));
  }
  std::sort(all.begin(), all.end(), [](const VersionStatus& a, const VersionStatus& b) {
    return std::tuple(!a.fault.empty(), a.version.number, a.version.hash) <
           std::tuple(!b.fault.empty(), b.version.number, b.version.hash);
  });
  return all;
}

bool Site::has(const std::string& hash) const {
  const std::vector<VersionStatus> all = versions();
  return std::any_of(all.begin(), all.end(), [&](const VersionStatus& one) {
    return one.version.hash == hash && one.fault.empty();
  });
}

VersionStatus Site::find(const std::string& name) const {
  const Decisions known = decisions();
  const std::vector<VersionStatus> all = versions(known);
  std::string wanted = name;
  if (name == "active") wanted = active().value_or("");
  if (name == "previous") {
    const auto& order = known.activations;
    wanted = order.size() < 2 ? "" : order[order.size() - 2];
  }
  if (name == "newest" && !all.empty()) {
    wanted = std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
               return a.version.number < b.version.number;
             })->version.hash;
  }
  std::vector<VersionStatus> found;
  for (const VersionStatus& status : all) {
    if (std::to_string(status.version.number) == wanted && status.fault.empty()) return status;
    if (wanted.size() >= 4 && status.version.hash.starts_with(wanted)) found.push_back(status);
  }
  if (found.size() == 1) return found.front();
  std::string there;
  for (const VersionStatus& status : all) {
    there += (there.empty() ? "" : ", ") + std::to_string(status.version.number) + " (" +
             log::short_hash(status.version.hash) + ")";
  }
  throw InputError(
      folder_.string(),
      found.empty() ? "has no version '" + name + "'" : "'" + name + "' begins several hashes",
      there.empty() ? "add one with `strata site add`" : "there are " + there);
}

std::string Site::fault_of(const std::string& hash) const {
  try {
    const MapVersion version = read_version(folder_ / kVersions / hash / kVersionFile);
    if (version.hash != hash) return "version.json is another version's";
    const log::HashedContent content = log::hash_content(maps_of(hash));
    if (content.hash == hash) return "";
    for (const log::HashedFile& file : version.files) {
      const auto same_name = [&](const log::HashedFile& other) { return other.path == file.path; };
      const auto there = std::find_if(content.files.begin(), content.files.end(), same_name);
      if (there == content.files.end()) return file.path + " is missing";
      if (there->sha256 != file.sha256) return file.path + " was changed";
    }
    return "there are files that are none of its own";
  } catch (const InputError& error) {
    return error.place() + " " + error.problem();
  }
}

void Site::require_good(const std::string& hash) const {
  const std::string fault = fault_of(hash);
  if (fault.empty()) return;
  throw InputError(maps_of(hash).string(), "is damaged: " + fault + ", so its hash does not hold",
                   "take another version; `strata site gc --damaged` takes this one away");
}

void Site::require_active(const From& from) const {
  if (!from || active().value_or("") == *from) return;
  throw InputError(folder_.string(), "has another active version by now",
                   "look at what is active, and ask again");
}

void Site::approve(const std::string& hash, const Actor& actor, const std::string& note,
                   const From& from) {
  Change change(*this);
  require_active(from);
  require_good(hash);
  Decision& decision = change.decisions.versions[hash];
  decision.approved = actor;
  decision.approval_note = note;
  add_event(change.decisions, "approve", hash, actor, note);
  change.commit();
}

void Site::point_to(const std::string& hash) {
  const fs::path link = folder_ / kActiveLink;
  std::error_code error;
  log::remove_left_over(link);
  const fs::path aside = log::staged_name(link);
  fs::remove(aside, error);
  fs::create_symlink(fs::path(kVersions) / hash / kMaps, aside, error);
  if (error) {
    throw OutputError(link.string(), "cannot be made: " + error.message(),
                      "check the permissions of the site's folder; its file system must have "
                      "symbolic links");
  }
  disk_->rename(aside, link);
  disk_->sync(folder_);
}

Switch Site::activate(const std::string& hash, const Actor& actor, const From& from) {
  Change change(*this);
  Decisions& decisions = change.decisions;
  const std::string before = active().value_or("");
  if (before == hash) return {before, hash};
  require_active(from);
  const auto found = decisions.versions.find(hash);
  if (found == decisions.versions.end() || !(found->second.approved || found->second.was_active)) {
    throw InputError(maps_of(hash).string(), "was not approved",
                     "look at it with `strata site diff`, then `strata site approve` it");
  }
  require_good(hash);
  std::erase(decisions.activations, hash);
  decisions.activations.push_back(hash);
  add_event(decisions, "activate", hash, actor, "");
  change.commit();
  point_to(hash);
  return {before, hash};
}

Switch Site::rollback(const Actor& actor, const std::string& from) {
  Change change(*this);
  Decisions& decisions = change.decisions;
  if (!from.empty()) require_active(from);
  if (decisions.activations.size() < 2) {
    throw InputError(folder_.string(), "has nothing to go back to: no version was active before",
                     "`strata site list` shows what there is, `strata site activate` takes one");
  }
  const Switch made{decisions.activations.back(), *(decisions.activations.rbegin() + 1)};
  require_good(made.to);
  decisions.activations.pop_back();
  add_event(decisions, "rollback", made.to, actor, "from " + log::short_hash(made.from));
  change.commit();
  point_to(made.to);
  return made;
}

}  // namespace strata::site
