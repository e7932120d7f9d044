// SPDX-License-Identifier: Apache-2.0
#include "components/incident_recorder/incident_folder.hpp"

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iomanip>
#include <optional>
#include <set>
#include <sstream>
#include <system_error>

#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "components/log/content_hash.hpp"
#include "components/log/disk.hpp"
#include "components/log/folder_name.hpp"
#include "components/log/stored_bytes.hpp"
#include "components/log/whole_file.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::incident_recorder {
namespace {

using nlohmann::json;

constexpr const char* kFiles = "files";
constexpr int kCopyAttempts = 3;
constexpr double kNsPerS = 1e9;

/// Another folder under the same name has another number.
std::optional<ino_t> number_of(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return std::nullopt;
  return status.st_ino;
}

json to_json(const IncidentRecord& record) {
  json reasons = json::array();
  for (const IncidentReason& reason : record.reasons) {
    reasons.push_back({{"kind", reason.kind}, {"source", reason.source}, {"text", reason.text}});
  }
  json files = json::array();
  for (const KeptFile& file : record.files) {
    const std::string copy = std::string("../") + kFiles + "/" + file.sha256 + "/" +
                             fs::path(file.source).filename().string();
    files.push_back({{"source", file.source}, {"sha256", file.sha256}, {"copy", copy}});
  }
  return {{"kind", "incident"},
          {"reasons", reasons},
          {"at", time_in_name(record.at_ns)},
          {"at_ns", record.at_ns},
          {"before_s", record.before_s},
          {"after_s", record.after_s},
          {"messages", record.messages},
          {"lost", record.lost},
          {"files", files},
          {"complete", record.is_complete}};
}

KeptFile keep_file(const fs::path& files, const std::string& source) {
  const fs::path path = log::without_slash(source);
  const fs::path aside = log::staged_name(files / "copy");
  for (int attempt = 0;; ++attempt) {
    fs::remove_all(aside);
    const auto before = number_of(path);
    fs::create_directories(aside);
    fs::copy(path, aside / path.filename(), fs::copy_options::recursive);
    if (before == number_of(path) || attempt + 1 == kCopyAttempts) break;
  }
  const std::string digest = log::content_digest(aside / path.filename());
  const fs::path place = files / digest;
  if (fs::exists(place / path.filename())) {
    fs::remove_all(aside);
  } else if (fs::exists(place)) {  // equal, under another name
    fs::rename(aside / path.filename(), place / path.filename());
    fs::remove_all(aside);
  } else {
    fs::rename(aside, place);
  }
  return {path.string(), digest};
}

/// What went wrong, in words that name no copy of ours.
std::string reason_of(const std::exception& error) {
  if (const auto* file = dynamic_cast<const fs::filesystem_error*>(&error)) {
    return file->code().message();
  }
  const auto* own = dynamic_cast<const Error*>(&error);
  return own != nullptr ? own->problem() : error.what();
}

}  // namespace

std::string time_in_name(std::int64_t unix_ns) {
  const auto seconds = static_cast<std::time_t>(static_cast<double>(unix_ns) / kNsPerS);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::ostringstream text;
  text << std::put_time(&utc, "%Y-%m-%dT%H-%M-%SZ");
  return text.str();
}

fs::path free_name(const fs::path& incidents, std::int64_t at_ns, const std::string& kind) {
  const std::string name = time_in_name(at_ns) + "_" + kind;
  fs::path folder = incidents / name;
  for (int number = 2; fs::exists(folder); ++number) {
    folder = incidents / (name + "_" + std::to_string(number));
  }
  return folder;
}

std::string json_text(const IncidentRecord& record) { return to_json(record).dump(2); }

void write_record(const IncidentRecord& record) {
  log::WholeFile file(record.folder / kIncidentFile);
  file.stream() << json_text(record) << "\n";
  file.commit();
}

std::optional<IncidentRecord> read_record(const fs::path& folder) {
  std::ifstream in(folder / kIncidentFile);
  const json text = json::parse(in, nullptr, false);
  if (!text.is_object() || text.value("kind", "") != "incident") return std::nullopt;
  IncidentRecord record;
  try {
    record.folder = folder;
    for (const json& reason : text.at("reasons")) {
      record.reasons.push_back({reason.at("kind"), reason.at("source"), reason.at("text")});
    }
    record.at_ns = text.at("at_ns");
    record.before_s = text.at("before_s");
    record.after_s = text.at("after_s");
    record.messages = text.at("messages");
    record.lost = text.at("lost");
    for (const json& file : text.at("files")) {
      record.files.push_back({file.at("source"), file.at("sha256")});
    }
    record.is_complete = text.at("complete");
  } catch (const json::exception&) {
    return std::nullopt;
  }
  if (record.reasons.empty()) return std::nullopt;
  record.bytes = log::stored_bytes(folder);
  return record;
}

std::optional<fs::path> kept_copy(const IncidentRecord& record, const std::string& sha256) {
  const bool is_kept = std::any_of(record.files.begin(), record.files.end(),
                                   [&](const KeptFile& file) { return file.sha256 == sha256; });
  if (!is_kept) return std::nullopt;
  const fs::path place = fs::absolute(record.folder).lexically_normal();
  const fs::path folder = log::without_slash(place).parent_path();
  // Equal contents lie together under each of their names.
  for (const KeptFile& file : record.files) {
    const fs::path copy = folder / kFiles / sha256 / log::without_slash(file.source).filename();
    if (file.sha256 == sha256 && fs::exists(copy)) return copy;
  }
  return std::nullopt;
}

std::vector<IncidentRecord> read_records(const fs::path& incidents) {
  std::vector<IncidentRecord> records;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(incidents, error)) {
    if (!entry.is_directory(error)) continue;
    if (auto record = read_record(entry.path())) records.push_back(std::move(*record));
  }
  std::sort(records.begin(), records.end(), [](const IncidentRecord& a, const IncidentRecord& b) {
    return std::pair(a.at_ns, a.folder) < std::pair(b.at_ns, b.folder);
  });
  return records;
}

std::vector<KeptFile> keep_files(const fs::path& incidents, const std::vector<std::string>& files,
                                 std::vector<std::string>& problems) {
  std::vector<KeptFile> kept;
  for (const std::string& source : files) {
    try {
      fs::create_directories(incidents / kFiles);
      kept.push_back(keep_file(incidents / kFiles, source));
    } catch (const std::exception& error) {  // one of them keeps no other from being kept
      problems.push_back(source + ": " + reason_of(error));
      std::error_code gone;
      fs::remove_all(log::staged_name(incidents / kFiles / "copy"), gone);
    }
  }
  return kept;
}

std::size_t make_room(const fs::path& incidents, std::uint64_t max_bytes) {
  const std::vector<IncidentRecord> records = read_records(incidents);
  std::size_t gone = 0;
  const auto bytes = [&] {
    std::uint64_t sum = 0;
    std::set<std::string> named;
    for (std::size_t i = gone; i < records.size(); ++i) {
      sum += records[i].bytes;
      for (const KeptFile& file : records[i].files) named.insert(file.sha256);
    }
    for (const std::string& digest : named) sum += log::stored_bytes(incidents / kFiles / digest);
    return sum;
  };
  while (gone + 1 < records.size() && bytes() > max_bytes) {
    log::real_disk().remove(records[gone].folder);
    ++gone;
  }
  std::set<std::string> named;
  for (std::size_t i = gone; i < records.size(); ++i) {
    for (const KeptFile& file : records[i].files) named.insert(file.sha256);
  }
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(incidents / kFiles, error)) {
    if (!named.contains(entry.path().filename().string())) log::real_disk().remove(entry.path());
  }
  return gone;
}

}  // namespace strata::incident_recorder
