// SPDX-License-Identifier: Apache-2.0
/// `strata info FOLDER`: what a verb or a component left there.
#include "tools/strata/info_folder.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "components/log/json_text.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/site/active_maps.hpp"
#include "components/site/site.hpp"
#include "core/base/error.hpp"
#include "tools/report/plot.hpp"
#include "tools/strata/info_store.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/site_text.hpp"
#include "tools/strata/words.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using Json = nlohmann::ordered_json;

/// What a folder of a kind (result_directory.hpp) is, in words.
struct Kind {
  const char* name;
  const char* text;
};

constexpr std::array<Kind, 8> kKinds{
    {{"maps", "maps, as `strata learn` writes them"},
     {"localization", "a localized run, as `strata localize` writes it"},
     {"comparison", "a comparison of maps, as `strata compare` writes it"},
     {"a shard", "a part of a comparison, as `strata compare --shard` writes it"},
     {"topology", "topologies, as `strata topology` writes them"},
     {"volume", "a 3-D map, as `strata volume` writes it"},
     {"changes", "changes of maps, as `strata changes` writes them"},
     {"simulation", "a simulated world, as `strata simulate` writes it"}}};

const Kind* kind_in_words(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error) || fs::exists(path / "metadata.yaml", error)) return nullptr;
  const std::string name = kind_of(path);
  const auto found = std::find_if(kKinds.begin(), kKinds.end(),
                                  [&](const Kind& kind) { return kind.name == name; });
  return found == kKinds.end() ? nullptr : &*found;
}

struct FileOfMaps {
  std::string name;
  std::uintmax_t bytes = 0;
  bool is_folder = false;
};

std::vector<FileOfMaps> entries_of(const fs::path& path) {
  std::vector<FileOfMaps> entries;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(path, error)) {
    const std::string name = entry.path().filename().string();
    if (name.front() == '.') continue;
    const bool is_folder = entry.is_directory(error);
    entries.push_back({name, is_folder ? 0 : entry.file_size(error), is_folder});
  }
  std::sort(entries.begin(), entries.end(),
            [](const FileOfMaps& a, const FileOfMaps& b) { return a.name < b.name; });
  return entries;
}

/// Null where there is none, or a damaged one.
Json summary_of(const fs::path& path) {
  std::ifstream in(path / maps::kSummaryFile);
  Json summary = Json::parse(in, nullptr, false);
  return summary.is_object() ? summary : Json(nullptr);
}

void print_learned(const Json& summary) {
  const auto number = [&](const char* key) {
    return summary.contains(key) && summary[key].is_number() ? summary[key].get<double>() : 0.0;
  };
  std::cout << "  learned    from " << counted(static_cast<std::size_t>(number("scans")), "scan")
            << " of " << counted(static_cast<std::size_t>(number("runs")), "run") << ", "
            << report::fixed(number("path_m"), 1) << " m, "
            << report::fixed(number("duration_s"), 1) << " s";
  if (summary.contains("log") && summary["log"].is_string()) {
    std::cout << ": " << summary["log"].get<std::string>();
  }
  std::cout << "\n";
}

void print_text(const fs::path& path, const Kind& kind) {
  std::cout << path.string() << ": " << kind.text << "\n";
  if (const Json summary = summary_of(path); summary.contains("scans")) print_learned(summary);
  for (const FileOfMaps& entry : entries_of(path)) {
    std::cout << "  " << (entry.is_folder ? "folder     " : "file       ") << entry.name;
    if (!entry.is_folder) std::cout << ", " << kilobytes(entry.bytes);
    std::cout << "\n";
  }
}

Json describe(const fs::path& path, const Kind& kind) {
  Json info;
  info["folder"] = path.string();
  info["kind"] = kind.name;
  info["files"] = Json::array();
  for (const FileOfMaps& entry : entries_of(path)) {
    info["files"].push_back({{"name", entry.name + (entry.is_folder ? "/" : "")},
                             {"bytes", entry.is_folder ? Json(nullptr) : Json(entry.bytes)}});
  }
  info["summary"] = summary_of(path);
  return info;
}

/// mapId, mapVersion and mapHash, as VDA 5050 names them.
void add_identity(const fs::path& path, Json& info) {
  try {
    const site::MapIdentity identity = site::identify(site::real_maps(path));
    info["mapId"] = identity.id;
    info["mapVersion"] = identity.version;
    info["mapHash"] = identity.hash;
  } catch (const InputError& error) {
    info["warnings"].push_back(error.what());
  }
}

bool is_site(const fs::path& path) {
  std::error_code error;
  return fs::exists(path / site::kSiteFile, error);
}

}  // namespace

bool is_result_folder(const fs::path& path) {
  return kind_in_words(path) != nullptr || is_site(path);
}

void print_folder(const fs::path& path, bool json) {
  if (is_site(path)) {
    const site::Site site(path);
    if (!json) return print_site(site);
    std::cout << json_of_site(site).dump(2) << "\n";
    return;
  }
  const Kind& kind = *kind_in_words(path);
  const fs::path store = path / maps::kStoreFile;
  const bool has_store = fs::exists(store);
  if (!json) {
    print_text(path, kind);
    if (!has_store) return;
    try {
      print_store(store, false);
    } catch (const InputError& error) {  // the rest of the folder is told all the same
      std::cout << "  note       " << error.what() << "\n";
    }
    return;
  }
  Json info = describe(path, kind);
  if (kind.name == std::string("maps")) add_identity(path, info);
  info["store"] = nullptr;
  if (has_store) {
    try {
      info["store"] = describe_store(store);
    } catch (const InputError& error) {
      info["warnings"].push_back(error.what());
    }
  }
  std::cout << log::json_text(info);
}

}  // namespace strata::tools
