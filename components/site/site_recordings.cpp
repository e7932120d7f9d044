// SPDX-License-Identifier: Apache-2.0
// The recordings that a site keeps for its gate.
#include <algorithm>
#include <charconv>
#include <system_error>

#include "components/log/folder_name.hpp"
#include "components/log/stored_bytes.hpp"
#include "components/log/whole_folder.hpp"
#include "components/site/site.hpp"
#include "components/site/site_change.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::site {
namespace {

constexpr const char* kRecordings = "recordings";
constexpr const char* kLog = "log";
constexpr const char* kTruth = "truth";
constexpr std::size_t kDigits = 6;

/// "000007_monday.clf" is 7; 0 for the name of no recording.
int number_of(const std::string& name) {
  int number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  const bool has_mark = end != name.data() + name.size() && *end == '_';
  return error == std::errc() && has_mark ? number : 0;
}

/// What lies in a folder that holds one thing; empty where there is none.
fs::path only_entry(const fs::path& folder) {
  std::error_code error;
  const fs::directory_iterator entries(folder, error);
  return error || entries == fs::directory_iterator() ? fs::path() : entries->path();
}

void copy_into(const fs::path& from, const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error) fs::copy(from, folder / from.filename(), fs::copy_options::recursive, error);
  if (error) {
    throw OutputError((folder / from.filename()).string(), "cannot be copied: " + error.message(),
                      "free some space, and check that " + from.string() + " can be read");
  }
}

/// Of programs that were killed while they kept or dropped one: ".NAME.partial-PID".
void remove_halves(const fs::path& recordings) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(recordings, error)) {
    const std::string name = entry.path().filename().string();
    const auto mark = name.rfind(".partial-");
    if (name.starts_with('.') && mark != std::string::npos) {
      log::remove_left_over(recordings / name.substr(1, mark - 1));
    }
  }
}

}  // namespace

std::vector<KeptRecording> Site::recordings() const {
  std::vector<KeptRecording> all;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_ / kRecordings, error)) {
    KeptRecording one;
    one.number = number_of(entry.path().filename().string());
    one.folder = entry.path();
    one.log = only_entry(one.folder / kLog);
    one.truth = only_entry(one.folder / kTruth);
    if (one.number == 0 || one.log.empty()) continue;
    one.bytes = log::stored_bytes(one.folder);
    all.push_back(std::move(one));
  }
  std::sort(all.begin(), all.end(),
            [](const KeptRecording& a, const KeptRecording& b) { return a.number < b.number; });
  return all;
}

std::vector<KeptRecording> Site::keep(const fs::path& log, const fs::path& truth,
                                      std::uint64_t max_bytes, const Actor& actor) {
  const fs::path source = log::without_slash(log);
  const std::uint64_t bytes =
      log::stored_bytes(source) + (truth.empty() ? 0 : log::stored_bytes(truth));
  if (bytes > max_bytes) {
    throw InputError(source.string(), "is larger than all that the site may keep",
                     "allow more with --max-mb, or cut it with `strata convert`");
  }
  Change change(*this);
  std::vector<KeptRecording> all = recordings();
  const int number = all.empty() ? 1 : all.back().number + 1;
  std::string name = std::to_string(number);
  name = std::string(kDigits - std::min(kDigits, name.size()), '0') + name + "_" +
         source.filename().string();
  std::error_code error;
  fs::create_directories(folder_ / kRecordings, error);
  remove_halves(folder_ / kRecordings);
  log::WholeFolder whole(folder_ / kRecordings / name, *disk_);
  copy_into(source, whole.aside() / kLog);
  if (!truth.empty()) copy_into(log::without_slash(truth), whole.aside() / kTruth);
  whole.commit();
  add_event(change.decisions, "keep", "", actor, name);
  change.commit();
  std::uint64_t sum = bytes;
  for (const KeptRecording& one : all) sum += one.bytes;
  std::vector<KeptRecording> gone;
  for (const KeptRecording& one : all) {
    if (sum <= max_bytes) break;
    // Out of sight at once: half a recording is none.
    const fs::path hidden = log::staged_name(one.folder);
    disk_->rename(one.folder, hidden);
    disk_->remove(hidden);
    sum -= one.bytes;
    gone.push_back(one);
  }
  return gone;
}

}  // namespace strata::site
