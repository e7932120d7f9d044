// SPDX-License-Identifier: Apache-2.0
#include "components/patch_learner/learner_store.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "components/log/state_store.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::patch_learner {

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
  return folder_ / ("scans_" + std::to_string(number) + ".db");
}

bool LearnerStore::has_state() const {
  std::error_code error;
  return fs::exists(state_file(), error);
}

int LearnerStore::restore(patch::OnlinePatchLearner& learner) {
  learner.restore_state(log::read_state_file(state_file()), state_file().string());
  int last_run = learner.last_run();
  const fs::path scans = scans_file(learner.status().scans_seen);
  if (!fs::exists(scans)) return last_run;
  const memory::Store store(scans, {.read_only = true});
  for (const int run : store.runs_with_scans()) {
    for (PosedScan& scan : store.load_scans(run)) (void)learner.add(std::move(scan));
    last_run = std::max(last_run, run);
  }
  return last_run;
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
    if (entry.path().filename().string().starts_with("scans_")) old.push_back(entry.path());
  }
  for (const fs::path& file : old) disk_.remove(file);  // with what SQLite keeps beside it
  scans_.emplace(scans);
}

}  // namespace strata::patch_learner
