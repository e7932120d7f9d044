// SPDX-License-Identifier: Apache-2.0
#include "components/patch_learner/learner_store.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "components/log/damaged_file.hpp"
#include "components/log/state_store.hpp"
#include "core/base/damage.hpp"

namespace fs = std::filesystem;

namespace strata::patch_learner {

namespace {

constexpr std::string_view kScans = "scans_";

/// Of scans_NUMBER.db; nothing for other files, and for one that was set aside.
std::optional<std::size_t> number_of(const fs::path& file) {
  const std::string name = file.stem().string();
  if (file.extension() != ".db" || !name.starts_with(kScans)) return std::nullopt;
  std::size_t number = 0;
  const char* const last = name.data() + name.size();
  const auto end = std::from_chars(name.data() + kScans.size(), last, number);
  if (end.ec != std::errc() || end.ptr != last) return std::nullopt;
  return number;
}

}  // namespace

LearnerStore::LearnerStore(fs::path folder, double state_period_s, const log::Disk& disk)
    : disk_(disk), folder_(std::move(folder)), state_period_s_(state_period_s) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) {
    throw OutputError(folder_.string(), "cannot be made: " + error.message(),
                      "check online.store.folder and the permissions");
  }
}

fs::path LearnerStore::scans_file(std::size_t number) const {
  return folder_ / (std::string(kScans) + std::to_string(number) + ".db");
}

bool LearnerStore::has_state() const {
  std::error_code error;
  return fs::exists(state_file(), error);
}

void LearnerStore::restore_state(patch::OnlinePatchLearner& learner) const {
  learner.restore_state(log::read_state_file(state_file()), state_file().string());
}

std::vector<fs::path> LearnerStore::scans_files(const patch::OnlinePatchLearner* restored) const {
  std::map<std::size_t, fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder_)) {
    const std::optional<std::size_t> number = number_of(entry.path());
    if (!number || (restored != nullptr && *number != restored->status().scans_seen)) continue;
    files[*number] = entry.path();
  }
  std::vector<fs::path> sorted;
  for (const auto& [number, file] : files) sorted.push_back(file);
  return sorted;
}

int LearnerStore::add_scans(const fs::path& file, patch::OnlinePatchLearner& learner) {
  memory::Store store(file, {.read_only = true});
  try {
    for (const int run : store.runs_with_scans()) {
      if (run < learner.last_run()) continue;  // of another life
      for (PosedScan& scan : store.load_scans(run)) (void)learner.add(std::move(scan));
    }
  } catch (const DamageError&) {
    store.leave_as_is();
    throw;
  }
  return learner.last_run();
}

int LearnerStore::restore(patch::OnlinePatchLearner& learner) const {
  restore_state(learner);
  for (const fs::path& file : scans_files(&learner)) (void)add_scans(file, learner);
  return learner.last_run();
}

void LearnerStore::begin(const patch::OnlinePatchLearner& learner) {
  write_state(learner);
  state_written_.reset();
}

void LearnerStore::add(const patch::OnlinePatchLearner& learner, const PosedScan& scan) {
  const Stamp now = scan.scan.stamp;
  if (scans_) {
    waiting_.push_back(scan);
    waiting_.back().static_probability = {};  // the learner does not need them
  }
  if (!state_written_) state_written_ = now;
  // A clock that was set back is one reason more.
  if (std::abs((now - *state_written_).seconds()) < state_period_s_) return;
  state_written_ = now;  // a disk that is full is not tried again with every scan
  write_state(learner);
}

void LearnerStore::flush() {
  if (!scans_ || waiting_.empty()) return;
  scans_->transaction([&] {
    // Runs come one after the other.
    for (auto begin = waiting_.cbegin(); begin != waiting_.cend();) {
      const auto end = std::find_if(begin, waiting_.cend(),
                                    [&](const PosedScan& scan) { return scan.run != begin->run; });
      scans_->append_scans(begin->run, {begin, end});
      begin = end;
    }
  });
  waiting_.clear();
}

void LearnerStore::finish(const patch::OnlinePatchLearner& learner) {
  if (!scans_) write_state(learner);
  flush();
}

void LearnerStore::write_state(const patch::OnlinePatchLearner& learner) {
  const std::vector<std::uint8_t> state = learner.save_state();
  const fs::path scans = scans_file(learner.status().scans_seen);
  // Should this fail, what is on disk stays as it is until a state can be written again: scans with
  // a gap before them would fit no state, and kept here they would grow without end.
  waiting_.clear();
  scans_.reset();
  log::write_state_file(state_file(), state, disk_);
  // From here on, after a power cut too, the state holds what the old scans file has.
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(folder_)) {
    const bool is_ours = entry.path().filename().string().starts_with(kScans);
    if (is_ours && !log::is_set_aside(entry.path())) old.push_back(entry.path());
  }
  for (const fs::path& file : old) disk_.remove(file);  // with what SQLite keeps beside it
  scans_.emplace(scans);
}

}  // namespace strata::patch_learner
