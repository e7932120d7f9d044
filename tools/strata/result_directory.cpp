// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/result_directory.hpp"

#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "components/log/json_text.hpp"
#include "components/maps/localization_files.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/base/error.hpp"
#include "memory/store/store_summary.hpp"
#include "tools/strata/written_names.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

constexpr const char* kKind = "kind";

/// An empty object where there is none.
nlohmann::json object_in(const fs::path& file) {
  std::ifstream in(file);
  nlohmann::json text = nlohmann::json::parse(in, nullptr, false);
  return text.is_object() ? text : nlohmann::json::object();
}

nlohmann::json summary_of(const fs::path& folder) { return object_in(folder / maps::kSummaryFile); }

/// A file that only one verb writes, for folders from before they said what they are, and for those
/// without a summary.
struct Mark {
  const char* file;
  const char* kind;
};
constexpr Mark kMarks[] = {
    {maps::kStoreFile, "maps"},      {"comparison.json", "comparison"},
    {"shard.json", "a shard"},       {maps::kMetricsFile, "localization"},
    {"topologies.json", "topology"}, {"map.bt", "volume"},
    {"changes.json", "changes"},     {"states.json", "simulation"},
    {"metadata.yaml", "a bag"},      {"incident.json", "an incident"},
    {"site.json", "a site"},         {"public/identity_ca.cert.pem", "a keystore"},
};

/// Near its begin.
bool has_text(const fs::path& file, std::string_view text) {
  std::string begin(4096, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin.find(text) != std::string::npos;
}

/// Whether `strata messages` wrote it.
bool is_our_package(const fs::path& file) { return has_text(file, "<name>strata_msgs</name>"); }

/// Whether a verb or a component wrote results of that kind there: a name alone may be the user's.
bool is_ours(const fs::path& folder, const std::string& kind) {
  if (summary_of(folder).contains(kKind) || kind == "messages") return true;
  if (kind == "maps") return memory::is_store(folder / maps::kStoreFile);
  if (kind == "localization") return object_in(folder / maps::kMetricsFile).contains("model");
  if (kind == "topology") return object_in(folder / "topologies.json").contains("visits");
  return kind == "volume" && has_text(folder / "map.bt", "# Octomap OcTree");
}

}  // namespace

std::string kind_of(const fs::path& folder) {
  const nlohmann::json summary = summary_of(folder);
  if (summary.contains(kKind) && summary[kKind].is_string()) return summary[kKind];
  std::error_code error;
  for (const Mark& mark : kMarks) {
    if (fs::exists(folder / mark.file, error)) return mark.kind;
  }
  if (is_our_package(folder / "package.xml")) return "messages";
  return "";
}

std::size_t runs_in(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder / maps::kStoreFile, error)) return 0;
  try {
    return memory::summarize_store(folder / maps::kStoreFile).runs.size();
  } catch (const InputError&) {
    return 0;  // nothing that could be lost
  }
}

void add_force(CLI::App& verb, VerbContext& context) {
  verb.add_flag("--force", context.options.force,
                "replace what is in --out even when it is another verb's, or has more in it");
}

void require_kind(const fs::path& folder, const std::string& kind, const VerbContext& context) {
  if (context.options.force || kind.empty()) return;
  const std::string there = kind_of(folder);
  if (there == kind && is_ours(folder, kind)) return;
  if (!there.empty() && there != kind) {
    throw OutputError(folder.string(), "holds " + there + ", which " + kind + " would replace",
                      "choose another --out, or give --force");
  }
  if (const std::string name = entry_in_the_way(folder, kind); !name.empty()) {
    throw OutputError(
        folder.string(),
        "has '" + name + "', which no verb has written, and which " + kind + " would replace",
        "move it away, choose another --out, or give --force");
  }
}

void require_no_more_runs(const fs::path& folder, std::size_t runs, const VerbContext& context) {
  if (context.options.force) return;
  const std::size_t there = runs_in(folder);
  if (there <= runs) return;
  throw OutputError(folder.string(),
                    "holds maps of " + std::to_string(there) + " runs, which those of " +
                        std::to_string(runs) + " would replace",
                    "go on from them with --update " + folder.string() +
                        ", choose another --out, or give --force");
}

ResultDirectory::ResultDirectory(const fs::path& target, std::string kind, VerbContext& context)
    : kind_(std::move(kind)), out_(target, context.staged()) {
  require_kind(target, kind_, context);
}

void ResultDirectory::commit() {
  nlohmann::json summary = summary_of(out_.path());
  summary[kKind] = kind_;
  const fs::path file = out_.path() / maps::kSummaryFile;
  std::ofstream out(file);
  out << log::json_text(summary);
  out.close();
  if (!out) throw OutputError(file.string(), "cannot be written", "free some space");
  out_.commit();
}

}  // namespace strata::tools
