// SPDX-License-Identifier: Apache-2.0
#include "components/site/decisions.hpp"

#include <algorithm>
#include <fstream>

#include "components/log/whole_file.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::site {
namespace {

using nlohmann::json;

constexpr const char* kDecisionsKind = "site";
constexpr int kFormat = 1;

json to_json(const Decision& decision) {
  json text{{"was_active", decision.was_active}};
  if (decision.approved) {
    text["approved"] = {{"by", decision.approved->by},
                        {"at_ns", decision.approved->at_ns},
                        {"note", decision.approval_note}};
  }
  return text;
}

Decision decision_from(const json& text) {
  Decision decision;
  decision.was_active = text.at("was_active");
  if (text.contains("approved")) {
    const json& approved = text.at("approved");
    decision.approved = Actor{approved.at("by"), approved.at("at_ns")};
    decision.approval_note = approved.at("note");
  }
  return decision;
}

Event event_from(const json& text) {
  return {text.at("what"), text.at("hash"), {text.at("by"), text.at("at_ns")}, text.at("note")};
}

Decisions decisions_from(const json& text) {
  Decisions decisions;
  decisions.id = text.at("id");
  decisions.frame = text.at("frame");
  decisions.next_number = text.at("next_number");
  for (const auto& [hash, decision] : text.at("versions").items()) {
    decisions.versions[hash] = decision_from(decision);
  }
  decisions.activations = text.at("activations").get<std::vector<std::string>>();
  for (const json& event : text.at("diary")) decisions.diary.push_back(event_from(event));
  return decisions;
}

}  // namespace

const char* name_of(VersionState state) {
  switch (state) {
    case VersionState::kCandidate:
      return "candidate";
    case VersionState::kApproved:
      return "approved";
    case VersionState::kActive:
      return "active";
    case VersionState::kRetired:
      return "retired";
  }
  return "";
}

void Decisions::agree_with(const std::optional<std::string>& active) {
  if (active) versions[*active].was_active = true;
  const std::string said = activations.empty() ? "" : activations.back();
  if (said == active.value_or("")) return;
  const auto found =
      active ? std::find(activations.rbegin(), activations.rend(), *active) : activations.rend();
  if (found != activations.rend()) {
    activations.erase(found.base(), activations.end());  // it was to be replaced, but for the link
  } else if (active) {
    activations.push_back(*active);  // it was to be rolled back from, but for the link
  } else {
    activations.clear();
  }
  const Actor nobody{"", diary.empty() ? 0 : diary.back().actor.at_ns};
  diary.push_back({"interrupted", said, nobody, "what was begun before was not done"});
}

json to_json(const Event& event) {
  return {{"what", event.what},         {"hash", event.hash},
          {"by", event.actor.by},       {"at", utc_text(event.actor.at_ns)},
          {"at_ns", event.actor.at_ns}, {"note", event.note}};
}

Decisions read_decisions(const fs::path& path) {
  std::ifstream in(path);
  if (!in) {
    throw InputError(path.parent_path().string(), "is no site: it has no site.json",
                     "make one with `strata site init`");
  }
  const json text = json::parse(in, nullptr, false);
  const char* remedy = "put back a copy of it; the versions and what is active lie beside it";
  if (!text.is_object() || text.value("kind", "") != kDecisionsKind) {
    throw InputError(path.string(), "is damaged", remedy);
  }
  if (text.value("format", 0) != kFormat) {
    throw InputError(path.string(), "is of a newer program", "use that one");
  }
  try {
    return decisions_from(text);
  } catch (const json::exception& error) {
    throw InputError(path.string(), std::string("is damaged: ") + error.what(), remedy);
  }
}

void write_decisions(const fs::path& path, const Decisions& decisions, const log::Disk& disk) {
  json versions = json::object();
  for (const auto& [hash, decision] : decisions.versions) versions[hash] = to_json(decision);
  json diary = json::array();
  const std::size_t gone = decisions.diary.size() - std::min(decisions.diary.size(), kMaxDiary);
  for (std::size_t i = gone; i < decisions.diary.size(); ++i) {
    diary.push_back(to_json(decisions.diary[i]));
  }
  const json text{{"kind", kDecisionsKind},
                  {"format", kFormat},
                  {"id", decisions.id},
                  {"frame", decisions.frame},
                  {"next_number", decisions.next_number},
                  {"versions", versions},
                  {"activations", decisions.activations},
                  {"diary", diary}};
  log::WholeFile file(path, disk);
  file.stream() << text.dump(2) << "\n";
  file.commit();
}

}  // namespace strata::site
