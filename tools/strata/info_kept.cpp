// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/info_kept.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <iostream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "components/log/byte_cursor.hpp"
#include "components/log/state_store.hpp"
#include "core/base/error.hpp"
#include "memory/store/store_summary.hpp"
#include "tools/strata/info_folder.hpp"
#include "tools/strata/info_store.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using Json = nlohmann::ordered_json;

/// The upper half of the first number of a saved state; the lower one is its version.
struct StateOf {
  std::uint32_t tag;
  const char* component;
};
constexpr std::array<StateOf, 3> kStates{{{0x53'53'4c'4d, "strata::ScanMatcher"},
                                          {0x53'4f'42'46, "strata::BeamFilter"},
                                          {0x53'50'4c'31, "strata::PatchLearner"}}};

std::string first_bytes(const fs::path& file) {
  std::array<char, 64> bytes{};
  std::ifstream in(file, std::ios::binary);
  in.read(bytes.data(), bytes.size());
  return {bytes.data(), static_cast<std::size_t>(in.gcount())};
}

/// Empty when it is none that is known.
std::string state_in_words(const fs::path& file) {
  try {
    const log::Bytes state = log::read_state_file(file);
    log::ByteCursor cursor{log::View(state)};
    const auto version = cursor.number<std::uint32_t>();
    const auto tag = cursor.number<std::uint32_t>();
    const auto found = std::find_if(kStates.begin(), kStates.end(),
                                    [&](const StateOf& state_of) { return state_of.tag == tag; });
    if (!cursor.ok() || found == kStates.end()) return "";
    return std::string("saved state of ") + found->component + ", version " +
           std::to_string(version);
  } catch (const Error&) {  // packed otherwise, or damaged
    return "";
  }
}

/// Of one file, in words; empty when it is nothing that a component keeps.
std::string kept_in_words(const fs::path& file) {
  constexpr std::string_view kZstd = "\x28\xb5\x2f\xfd";
  const std::string begin = first_bytes(file);
  if (begin.starts_with(kZstd)) return state_in_words(file);
  if (begin.starts_with("version: 1\nmap_from_robot:")) return "last pose of strata::Localizer";
  if (begin.starts_with("# Octomap OcTree")) return "octree, as strata::VolumeMapper keeps it";
  return "";
}

struct Entry {
  std::string name;
  std::string what;
  std::uintmax_t bytes = 0;
};

/// In order of their names; what is none of the kind is left out. depth: of folders in it.
std::vector<Entry> entries_of(const fs::path& folder, int depth) {
  std::vector<Entry> entries;
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
            [](const Entry& a, const Entry& b) { return a.name < b.name; });
  return entries;
}

Json describe(const std::string& path, const std::vector<Entry>& entries) {
  Json info;
  info["folder"] = path;
  info["kind"] = "kept";
  info["files"] = Json::array();
  for (const Entry& entry : entries) {
    const bool is_folder = entry.name.back() == '/';
    info["files"].push_back({{"name", entry.name},
                             {"what", entry.what},
                             {"bytes", is_folder ? Json(nullptr) : Json(entry.bytes)}});
  }
  return info;
}

bool print_kept_folder(const fs::path& path, bool json) {
  const std::vector<Entry> entries = entries_of(path, 1);
  if (entries.empty()) return false;
  if (json) {
    std::cout << describe(path.string(), entries).dump(2) << "\n";
    return true;
  }
  std::cout << path.string() << ": what components keep (`strata info` of each says more)\n";
  for (const Entry& entry : entries) {
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
    std::cout << Json{{"file", path.string()}, {"what", what}, {"bytes", bytes}}.dump(2) << "\n";
  } else {
    std::cout << path.string() << ": " << what << ", " << kilobytes(bytes) << "\n";
  }
  return true;
}

}  // namespace strata::tools
