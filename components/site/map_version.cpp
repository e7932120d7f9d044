// SPDX-License-Identifier: Apache-2.0
#include "components/site/map_version.hpp"

#include <ctime>
#include <fstream>
#include <iomanip>
#include <sstream>

#include "components/log/sha256.hpp"
#include "components/log/whole_file.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::site {
namespace {

using nlohmann::json;

constexpr const char* kVersionKind = "map version";
constexpr const char* kChecksum = "checksum";
constexpr std::int64_t kNsPerS = 1'000'000'000;

InputError damaged(const fs::path& file, const std::string& why) {
  return {file.string(), why,
          "this version cannot be used; `strata site gc --damaged` takes it away"};
}

MapVersion from_json(const json& text) {
  MapVersion version;
  version.hash = text.at("hash");
  version.number = text.at("number");
  version.parent = text.at("parent").is_null() ? "" : text.at("parent").get<std::string>();
  version.made = {text.at("by"), text.at("at_ns")};
  version.note = text.at("note");
  version.site = text.at("mapId");
  version.frame = text.at("frame");
  version.facts = text.at("made_of");
  for (const json& file : text.at("files")) {
    version.files.push_back({file.at("path"), file.at("sha256"), file.at("bytes")});
  }
  return version;
}

}  // namespace

std::uint64_t MapVersion::bytes() const {
  std::uint64_t sum = 0;
  for (const log::HashedFile& file : files) sum += file.bytes;
  return sum;
}

std::string utc_text(std::int64_t unix_ns) {
  const std::time_t seconds = unix_ns / kNsPerS;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::ostringstream text;
  text << std::put_time(&utc, "%Y-%m-%dT%H:%M:%SZ");
  return text.str();
}

json to_json(const MapVersion& version) {
  json files = json::array();
  for (const log::HashedFile& file : version.files) {
    files.push_back({{"path", file.path}, {"sha256", file.sha256}, {"bytes", file.bytes}});
  }
  return {{"kind", kVersionKind},
          {"hash", version.hash},
          {"number", version.number},
          {"parent", version.parent.empty() ? json(nullptr) : json(version.parent)},
          {"by", version.made.by},
          {"at", utc_text(version.made.at_ns)},
          {"at_ns", version.made.at_ns},
          {"note", version.note},
          {"mapId", version.site},
          {"frame", version.frame},
          {"made_of", version.facts},
          {"files", files}};
}

void write_version(const fs::path& path, const MapVersion& version) {
  json text = to_json(version);
  text[kChecksum] = log::sha256_of(text.dump());
  log::WholeFile file(path);
  file.stream() << text.dump(2) << "\n";
  file.commit();
}

MapVersion read_version(const fs::path& path) {
  std::ifstream in(path);
  json text = json::parse(in, nullptr, false);
  if (!text.is_object() || text.value("kind", "") != kVersionKind) {
    throw damaged(path, "is missing, cut or no description of a version");
  }
  const std::string checksum = text.value(kChecksum, "");
  text.erase(kChecksum);
  if (log::sha256_of(text.dump()) != checksum) {
    throw damaged(path, "was changed: its checksum does not hold");
  }
  try {
    return from_json(text);
  } catch (const json::exception& error) {
    throw damaged(path, std::string("is not as this program writes it: ") + error.what());
  }
}

json facts_of(const fs::path& maps) {
  std::ifstream in(maps / maps::kSummaryFile);
  const json summary = json::parse(in, nullptr, false);
  json facts = json::object();
  if (!summary.is_object()) return facts;
  for (const char* key : {"log", "runs", "scans", "path_m", "duration_s", "consistency"}) {
    if (summary.contains(key)) facts[key] = summary[key];
  }
  if (summary.contains("submaps")) facts["submaps"] = summary["submaps"].size();
  return facts;
}

}  // namespace strata::site
