// SPDX-License-Identifier: Apache-2.0
/// What an online learner has learned, in a folder, so that a restarted one goes on from it.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "components/log/disk.hpp"
#include "core/base/time.hpp"
#include "core/patch/online_learner.hpp"
#include "memory/store/store.hpp"

namespace strata::patch_learner {

/// The learner's state, written now and then, and the scans since then, written as they come: after
/// a crash the two together are the learner as of the last flush. A state is numbered by
/// the scans it has seen, and the scans after it are in scans_NUMBER.db, so that a crash between
/// two writes leaves one pair that fits; so does a power cut, since scans go only when the state
/// that holds them is on the disk. Not thread-safe.
class LearnerStore {
 public:
  /// Makes the folder. Throws OutputError.
  LearnerStore(std::filesystem::path folder, double state_period_s,
               const log::Disk& disk = log::real_disk());

  /// Whether something is stored.
  [[nodiscard]] bool has_state() const;
  [[nodiscard]] std::filesystem::path state_file() const { return folder_ / "learner.state"; }
  /// Restores the stored state; the learner must be new, and is of no use when this throws.
  /// Throws InputError, DamageError for a file that is damaged; it stays as it is.
  void restore_state(patch::OnlinePatchLearner& learner) const;
  /// The files of the scans after the state that was restored into the learner, in order; without
  /// one, when it is lost, of all scans that there are.
  [[nodiscard]] std::vector<std::filesystem::path> scans_files(
      const patch::OnlinePatchLearner* restored) const;
  /// Adds the scans of such a file to the learner, run by run, and gives the number of the last
  /// run. Throws as restore_state; the learner then has the runs before the damage.
  static int add_scans(const std::filesystem::path& file, patch::OnlinePatchLearner& learner);
  /// Restores what is stored and adds the scans after it; the learner must be new. Gives the number
  /// of the last run. Throws InputError for files that are damaged; they stay as they are.
  int restore(patch::OnlinePatchLearner& learner) const;
  /// The learner is at its beginning, or was restored: from here on `add` may be called. Throws
  /// OutputError.
  void begin(const patch::OnlinePatchLearner& learner);
  /// The learner has just taken the scan: it is written by the next flush. Throws OutputError when
  /// a state was due and could not be written; it is tried again when the next one is due, and
  /// until then the files stay as they were.
  void add(const patch::OnlinePatchLearner& learner, const PosedScan& scan);
  /// Writes the scans that are not written yet; none while a state could not be written. Throws
  /// OutputError.
  void flush();
  /// Writes what is not written yet: the scans, or the state that could not be written. Throws
  /// OutputError.
  void finish(const patch::OnlinePatchLearner& learner);

 private:
  [[nodiscard]] std::filesystem::path scans_file(std::size_t number) const;
  void write_state(const patch::OnlinePatchLearner& learner);

  const log::Disk& disk_;
  std::filesystem::path folder_;
  double state_period_s_;
  std::optional<memory::Store> scans_;
  std::vector<PosedScan> waiting_;
  std::optional<Stamp> state_written_;
};

}  // namespace strata::patch_learner
