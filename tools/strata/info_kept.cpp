// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/info_kept.hpp"

#include <algorithm>
#include <cstdint>
#include <iostream>
#include <string>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "components/log/json_text.hpp"
#include "components/log/kept_file.hpp"
#include "components/log/state_store.hpp"
#include "core/base/error.hpp"
#include "memory/store/store_summary.hpp"
#include "tools/strata/info_folder.hpp"
#include "tools/strata/info_store.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using Json = nlohmann::ordered_json;

/// Of one file, in words; empty when it is nothing that a component keeps, or damaged. Stores say
/// more by themselves (info_store.hpp).
std::string kept_in_words(const fs::path& file) {
  std::string what = log::kept_in_words(file);
  if (what == log::kDatabase) return "";
  if (!what.starts_with("saved state")) return what;
  try {
    (void)log::read_state_file(file);
    return what;
  } catch (const Error&) {
    return "";
  }
}

struct KeptEntry {
  std::string name;
  std::string what;
  std::uintmax_t bytes = 0;
};

/// In order of their names; what is none of the kind is left out. depth: of folders in it.
std::vector<KeptEntry> entries_of(const fs::path& folder, int depth) {
  std::vector<KeptEntry> entries;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const fs::path& path = entry.path();
    std::string name = path.filename().string();
    if (name.front() == '.') continue;
    if (entry.is_directory(error)) {
      std::string what = is_result_folder(path) ? "maps or results" : "";
      if (what.empty() && depth > 0 && !entries_of(path, depth - 1).empty()) {
        what = "what components keep";
      }
      if (!what.empty()) entries.push_back({name + "/", std::move(what)});
    } else if (entry.is_regular_file(error)) {
      std::string what = memory::is_store(path) ? "Strata store" : kept_in_words(path);
      if (!what.empty())
        entries.push_back({std::move(name), std::move(what), entry.file_size(error)});
    }
  }
  std::sort(entries.begin(), entries.end(),
            [](const KeptEntry& a, const KeptEntry& b) { return a.name < b.name; });
  return entries;
}

Json describe(const std::string& path, const std::vector<KeptEntry>& entries) {
  Json info;
  info["folder"] = path;
  info["kind"] = "kept";
  info["files"] = Json::array();
  for (const KeptEntry& entry : entries) {
    const bool is_folder = entry.name.back() == '/';
    info["files"].push_back({{"name", entry.name},
                             {"what", entry.what},
                             {"bytes", is_folder ? Json(nullptr) : Json(entry.bytes)}});
  }
  return info;
}

bool print_kept_folder(const fs::path& path, bool json) {
  const std::vector<KeptEntry> entries = entries_of(path, 1);
  if (entries.empty()) return false;
  if (json) {
    std::cout << log::json_text(describe(path.string(), entries));
    return true;
  }
  std::cout << path.string() << ": what components keep (`strata info` of each says more)\n";
  for (const KeptEntry& entry : entries) {
    const bool is_folder = entry.name.back() == '/';
    std::cout << (is_folder ? "  folder     " : "  file       ") << entry.name << ", "
              << entry.what;
    if (!is_folder) std::cout << ", " << kilobytes(entry.bytes);
    std::cout << "\n";
  }
  return true;
}

}  // namespace

bool print_kept(const fs::path& path, bool json) {
  std::error_code error;
  if (fs::is_directory(path, error)) return print_kept_folder(path, json);
  if (!fs::is_regular_file(path, error)) return false;
  const std::string what = kept_in_words(path);
  if (what.empty()) return false;
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (json) {
    std::cout << log::json_text(Json{{"file", path.string()}, {"what", what}, {"bytes", bytes}});
  } else {
    std::cout << path.string() << ": " << what << ", " << kilobytes(bytes) << "\n";
  }
  return true;
}

}  // namespace strata::tools
