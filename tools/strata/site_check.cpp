// SPDX-License-Identifier: Apache-2.0
/// `strata site check`, `approve`, `take` and `diff`: what is said of a version before it is
/// activated.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "tools/report/plot.hpp"
#include "tools/site/gate.hpp"
#include "tools/site/gate_report.hpp"
#include "tools/site/map_diff.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/site_actions.hpp"
#include "tools/strata/site_text.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {
namespace {

InputError refused(const site::VersionStatus& version, const site::GateReport& report) {
  return {
      "version " + name_of(version), "was refused: " + in_short(report),
      "`strata site check --out DIR` draws why; `approve --unchecked` approves it all the same"};
}

/// The recordings that are named, or the newest that are kept.
pipeline::RunsInput input_of(const SiteOptions& options, const site::Site& site) {
  pipeline::RunsInput input = options.input;
  if (!input.logs.empty()) return input;
  std::vector<site::KeptRecording> kept = site.recordings();
  if (kept.size() > options.recordings) {
    kept.erase(kept.begin(), kept.end() - static_cast<std::ptrdiff_t>(options.recordings));
  }
  const bool has_truth = std::all_of(
      kept.begin(), kept.end(), [](const auto& recording) { return !recording.truth.empty(); });
  for (const site::KeptRecording& recording : kept) {
    input.logs.push_back(recording.log.string());
    if (has_truth) input.truths.push_back(recording.truth.string());
  }
  return input;
}

/// What the gate says of a version beside `active`, with its report in --out.
site::GateReport look_at(const SiteOptions& options, VerbContext& context, const site::Site& site,
                         const site::VersionStatus& version,
                         const std::optional<std::string>& active) {
  const auto config = read_config<site::GateConfig>(context);
  std::optional<ResultDirectory> out;
  if (!options.out.empty()) out.emplace(options.out, "a check", context);
  site::GateTask task;
  task.candidate = site.maps_of(version.version.hash);
  if (active && *active != version.version.hash) task.active = site.maps_of(*active);
  for (const site::VersionStatus& other : site.versions()) {
    const bool is_earlier = other.decision.was_active && other.fault.empty() &&
                            other.version.hash != version.version.hash;
    if (is_earlier) task.earlier.push_back(site.maps_of(other.version.hash));
  }
  task.is_whole = [&site](const std::filesystem::path& maps) {
    return site.fault_of(maps.parent_path().filename().string()).empty();
  };
  task.input = input_of(options, site);
  task.model = options.model;
  task.seed = context.options.seed;
  task.threads = context.options.threads;
  site::GateReport report;
  const std::string fault = site.fault_of(version.version.hash);
  report.checks.push_back({"hash", "", fault.empty(), fault.empty() ? "the hash holds" : fault});
  if (!fault.empty()) return report;
  report = site::run_gate(task, config, context.progress());
  report.checks.insert(report.checks.begin(), {"hash", "", true, "the hash holds"});
  if (out) {
    const std::string title =
        "Version " + name_of(version) + " of " + site.decisions().id + " against the active one";
    write_gate_report(out->path(), title, task, report);
    out->commit();
  }
  return report;
}

std::string line_of(const site::MapChange& change) {
  using report::fixed;
  std::string line = "  " + std::string(site::name_of(change.kind)) + " at (" +
                     fixed(change.center_m.x(), 2) + ", " + fixed(change.center_m.y(), 2) + "), " +
                     fixed(change.area_m2, 2) + " m2, confidence " + fixed(change.confidence, 2);
  if (change.from_m) {
    line += ", from (" + fixed(change.from_m->x(), 2) + ", " + fixed(change.from_m->y(), 2) + ")";
  }
  return line + "\n";
}

}  // namespace

void compare_versions(const SiteOptions& options, VerbContext& context) {
  const site::Site site = open_site(options, context);
  const site::VersionStatus before = site.find(options.version);
  const site::VersionStatus after = site.find(options.other);
  std::optional<ResultDirectory> out;
  if (!options.out.empty()) out.emplace(options.out, "a difference", context);
  const site::DiffSide old_maps = site::read_diff_side(site.maps_of(before.version.hash));
  const site::DiffSide new_maps = site::read_diff_side(site.maps_of(after.version.hash));
  const site::MapDiff diff = site::map_diff(old_maps, new_maps);
  nlohmann::json geojson = to_geojson(diff, site.decisions().frame);
  geojson["from"] = before.version.hash;
  geojson["to"] = after.version.hash;
  if (out) {
    report::write_file(out->path() / "diff.png",
                       report::encode_png(draw(diff, old_maps, new_maps)));
    report::write_file(out->path() / "diff.geojson", geojson.dump(2) + "\n");
    out->commit();
  }
  std::string text = counted(diff.changes.size(), "difference") + " from version " +
                     name_of(before) + " to " + name_of(after) + "\n";
  for (const site::MapChange& change : diff.changes) text += line_of(change);
  text.pop_back();
  answer(options, context, text, geojson);
}

void check_version(const SiteOptions& options, VerbContext& context) {
  const site::Site site = open_site(options, context);
  const site::VersionStatus version = site.find(options.version);
  const site::GateReport report = look_at(options, context, site, version, site.active());
  answer(options, context,
         "version " + name_of(version) + (report.passed() ? " may" : " must not") +
             " be activated:\n" + to_text(report),
         to_json(report));
  if (!report.passed()) throw refused(version, report);
}

void take_maps(const SiteOptions& options, VerbContext& context) {
  site::Site site = open_site(options, context);
  const std::optional<std::string> active = site.active();
  if (active && input_of(options, site).logs.empty()) {
    throw InputError(options.folder,
                     "keeps no recording, so that nobody can tell whether robots "
                     "would do worse",
                     "keep one with `strata site keep`, or name one with --log");
  }
  const site::Site::Added added = site.add(options.maps, actor(options), options.note);
  const std::string name = name_of(added.status);
  const std::string& hash = added.status.version.hash;
  if (added.status.state == site::VersionState::kActive) {
    answer(options, context, "these maps are version " + name + " already, active",
           json_of(added.status));
    return;
  }
  const site::GateReport report = look_at(options, context, site, added.status, active);
  if (!report.passed()) throw refused(added.status, report);
  // Somebody may have gone back to another version meanwhile, which nothing was compared with.
  const std::string from = active.value_or("");
  site.approve(hash, actor(options), in_short(report), from);
  (void)site.activate(hash, actor(options), from);
  answer(options, context, "version " + name + " is active: " + in_short(report),
         json_of(site.find(hash)));
}

void approve_version(const SiteOptions& options, VerbContext& context) {
  site::Site site = open_site(options, context);
  const site::VersionStatus version = site.find(options.version);
  std::string note = options.note;
  if (options.unchecked) {
    if (note.empty()) note = "unchecked";
  } else {
    const site::GateReport report = look_at(options, context, site, version, site.active());
    if (!report.passed()) throw refused(version, report);
    note += (note.empty() ? "" : "; ") + in_short(report);
  }
  site.approve(version.version.hash, actor(options), note);
  answer(options, context, "approved version " + name_of(version) + ": " + note,
         json_of(site.find(version.version.hash)));
}

void add_gate_options(CLI::App& action, SiteOptions& options) {
  action
      .add_option("--log", options.input.logs,
                  "a recording that robots are driven through in both versions; may be repeated")
      ->take_all()
      ->allow_extra_args(false);
  action
      .add_option("--truth", options.input.truths,
                  "true poses of a recording, as `strata localize` takes them; one each --log")
      ->take_all()
      ->allow_extra_args(false);
  action
      .add_option(
          "--recordings", options.recordings,
          "without --log: so many of the recordings that the site keeps, the newest; 0: none")
      ->capture_default_str();
  action.add_option("--model", options.model,
                    "map model to drive with; patch where both versions have one, else filtered");
  action.add_option("--out", options.out, "folder for report.html, check.json and pictures");
}

}  // namespace strata::tools
