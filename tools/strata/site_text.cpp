// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/site_text.hpp"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <vector>

#include "components/log/content_hash.hpp"
#include "components/log/text.hpp"
#include "core/base/error.hpp"
#include "tools/report/plot.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {
namespace {

using nlohmann::json;
using site::VersionState;
using site::VersionStatus;

constexpr double kBytesInMegabyte = 1e6;

/// "2 runs, 8000 scans, 412 m", as far as the maps say.
std::string made_of(const site::MapVersion& version) {
  const json& facts = version.facts;
  const auto number = [&](const char* key) { return facts.value(key, 0.0); };
  std::string text;
  if (!facts.is_object() || !facts.contains("runs")) return "of unknown runs";
  text += counted(static_cast<std::size_t>(number("runs")), "run") + ", ";
  text += counted(static_cast<std::size_t>(number("scans")), "scan") + ", ";
  char rest[64];
  std::snprintf(rest, sizeof rest, "%.0f m, %.1f MB", number("path_m"),
                static_cast<double>(version.bytes()) / kBytesInMegabyte);
  return text + rest;
}

void print_version(const VersionStatus& status) {
  const site::MapVersion& version = status.version;
  const std::string hash = log::short_hash(version.hash);
  if (!status.fault.empty()) {
    std::printf("   ?  %s  damaged    %s\n", hash.c_str(), status.fault.c_str());
    return;
  }
  std::printf("%4d  %s  %-9s  %s  %s; of %s%s%s\n", version.number, hash.c_str(),
              site::name_of(status.state), site::utc_text(version.made.at_ns).c_str(),
              version.made.by.c_str(), made_of(version).c_str(), version.note.empty() ? "" : ": ",
              version.note.c_str());
}

std::optional<VersionStatus> find_hash(const std::vector<VersionStatus>& all,
                                       const std::string& hash) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const VersionStatus& status) {
    return status.version.hash == hash;
  });
  if (found == all.end()) return std::nullopt;
  return *found;
}

/// The version that `rollback` would give back; "" for none.
std::string previous_of(const site::Decisions& decisions) {
  const auto& order = decisions.activations;
  return order.size() < 2 ? "" : order[order.size() - 2];
}

std::string fault_of_active(const site::Site& site) {
  const auto active = site.active();
  return active ? site.fault_of(*active) : "";
}

/// The name of its floor plan's file, or what is wrong with it; empty where it has none.
std::string plan_of(const site::Site& site) {
  try {
    const auto plan = site.plan();
    return plan ? plan->drawing.name : "";
  } catch (const InputError& error) {
    return std::string("DAMAGED: ") + error.what();
  }
}

json json_or_null(const std::optional<VersionStatus>& status) {
  return status ? json_of(*status) : json(nullptr);
}

}  // namespace

json json_of(const VersionStatus& status) {
  json text = site::to_json(status.version);
  text.erase("files");
  text["mapVersion"] = std::to_string(status.version.number);
  text["mapHash"] = status.version.hash;
  text["bytes"] = status.version.bytes();
  text["state"] = site::name_of(status.state);
  text["fault"] = status.fault;
  text["approved"] = nullptr;
  if (const auto& approved = status.decision.approved) {
    text["approved"] = {{"by", approved->by},
                        {"at", site::utc_text(approved->at_ns)},
                        {"note", status.decision.approval_note}};
  }
  return text;
}

std::string name_of(const VersionStatus& status) {
  return std::to_string(status.version.number) + " (" + log::short_hash(status.version.hash) + ")";
}

void print_versions(const site::Site& site) {
  for (const VersionStatus& status : site.versions()) print_version(status);
  std::fflush(stdout);
}

json json_of_versions(const site::Site& site) {
  json all = json::array();
  for (const VersionStatus& status : site.versions()) all.push_back(json_of(status));
  return all;
}

json json_of_site(const site::Site& site) {
  const site::Decisions decisions = site.decisions();
  const std::vector<VersionStatus> all = site.versions();
  const auto count = [&](VersionState state) {
    return std::count_if(all.begin(), all.end(),
                         [&](const VersionStatus& status) { return status.state == state; });
  };
  json diary = json::array();
  for (const site::Event& event : decisions.diary) diary.push_back(site::to_json(event));
  const std::optional<std::string> active = site.active();
  const std::string plan = plan_of(site);
  json text{{"kind", "site"},
            {"folder", site.folder().string()},
            {"mapId", decisions.id},
            {"frame", decisions.frame},
            {"active", active ? json_or_null(find_hash(all, *active)) : json(nullptr)},
            {"active_fault", fault_of_active(site)},
            {"previous", json_or_null(find_hash(all, previous_of(decisions)))},
            {"candidates", count(VersionState::kCandidate)},
            {"approved", count(VersionState::kApproved)},
            {"retired", count(VersionState::kRetired)},
            {"plan", plan.empty() ? json(nullptr) : json(plan)},
            {"diary", diary}};
  for (const site::Level& level : site.levels()) text["levels"].push_back(level.name);
  return text;
}

void print_site(const site::Site& site) {
  const site::Decisions decisions = site.decisions();
  const std::vector<VersionStatus> all = site.versions();
  std::printf("%s: site %s, in frame %s\n", site.folder().c_str(), decisions.id.c_str(),
              decisions.frame.c_str());
  const std::optional<std::string> active = site.active();
  const auto now = active ? find_hash(all, *active) : std::nullopt;
  const auto levels = site.levels();
  for (auto level = levels.rbegin(); level != levels.rend(); ++level) {
    std::printf("  level     %s: `strata site status %s`\n", level->name.c_str(),
                level->folder.c_str());
  }
  if (now) {
    std::printf("  active    %s, of %s\n", name_of(*now).c_str(), made_of(now->version).c_str());
  } else if (levels.empty()) {
    std::printf("  active    none%s\n", active ? ": the link leads to a version that is gone" : "");
  }
  const std::string fault = fault_of_active(site);
  if (!fault.empty()) std::printf("  DAMAGED   %s; `strata site rollback`\n", fault.c_str());
  if (const auto previous = find_hash(all, previous_of(decisions))) {
    std::printf("  before    %s: what `strata site rollback` gives back\n",
                name_of(*previous).c_str());
  }
  for (const VersionStatus& status : all) {
    if (status.state == VersionState::kCandidate && status.fault.empty()) {
      std::printf("  waits     %s, to be approved\n", name_of(status).c_str());
    } else if (status.state == VersionState::kApproved) {
      std::printf("  waits     %s, approved, to be activated\n", name_of(status).c_str());
    }
  }
  if (const std::string plan = plan_of(site); !plan.empty()) {
    std::printf("  plan      %s; `strata site plan %s show`\n", plan.c_str(),
                site.folder().c_str());
  }
  std::fflush(stdout);
}

void print_diary(const site::Site& site, std::size_t count) {
  const std::vector<site::Event> diary = site.decisions().diary;
  for (std::size_t i = diary.size() - std::min(count, diary.size()); i < diary.size(); ++i) {
    const site::Event& event = diary[i];
    std::printf("  %s  %-11s %-12s  %s%s%s\n", site::utc_text(event.actor.at_ns).c_str(),
                event.what.c_str(), log::short_hash(event.hash).c_str(), event.actor.by.c_str(),
                event.note.empty() ? "" : ": ", event.note.c_str());
  }
  std::fflush(stdout);
}

std::string words_of(const site::Zone& zone) {
  using report::fixed;
  std::string words = site::name_of(zone.kind);
  if (zone.kind == site::ZoneKind::kLearn) words = site::name_of(zone.control);
  if (zone.kind == site::ZoneKind::kKeepout && zone.cost_percent < 100.0) {
    words += " at a cost of " + log::format_number(zone.cost_percent) + " %";
  }
  if (zone.speed_percent) words += " " + log::format_number(*zone.speed_percent) + " %";
  if (zone.speed_m_s) words += " " + log::format_number(*zone.speed_m_s) + " m/s";
  for (std::size_t i = 0; i < zone.levels.size(); ++i) {
    words += (i == 0 ? " between levels " : ", ") + zone.levels[i];
  }
  return words + ", " + fixed(site::area_m2(zone), 2) + " m2";
}

nlohmann::json json_of(const site::Zone& zone) {
  json text{
      {"name", zone.name}, {"kind", site::name_of(zone.kind)}, {"area_m2", site::area_m2(zone)}};
  if (zone.kind == site::ZoneKind::kLearn) text["control"] = site::name_of(zone.control);
  if (zone.kind == site::ZoneKind::kKeepout) text["cost_percent"] = zone.cost_percent;
  if (zone.speed_percent) text["speed_percent"] = *zone.speed_percent;
  if (zone.speed_m_s) text["speed_m_s"] = *zone.speed_m_s;
  if (!zone.levels.empty()) text["levels"] = zone.levels;
  return text;
}

}  // namespace strata::tools
