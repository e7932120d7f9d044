// SPDX-License-Identifier: Apache-2.0
/// Learning again from scans that a loop closure has moved, on a thread of its own.
#pragma once

#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <vector>

#include "components/log/newest_work.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/patch/online_learner.hpp"
#include "core/scan/scan.hpp"

namespace strata::patch_learner {

/// Makes a learner of moved scans while the one that runs goes on. Takes the memory of a second
/// learner meanwhile. One thread at a time may call it.
class Relearner {
 public:
  /// threads: of the learners that it makes.
  Relearner(patch::PatchLearnerConfig config, patch::OnlineConfig online, int threads);
  /// Gives up what it is doing.
  ~Relearner();
  Relearner(const Relearner&) = delete;
  Relearner& operator=(const Relearner&) = delete;

  /// Returns at once. scans: in the order in which they came, at their new poses. base: the static
  /// map. To be called when it is not busy and what it made was taken.
  void begin(std::vector<PosedScan> scans, ReflectionGrid base);
  [[nodiscard]] bool is_busy() const { return work_.is_busy(); }
  /// What it made, once; null before that. Throws what ended the work, which then made nothing.
  [[nodiscard]] std::unique_ptr<patch::OnlinePatchLearner> take();

 private:
  struct Job {
    std::vector<PosedScan> scans;
    ReflectionGrid base;
  };
  void work_on(Job job);

  patch::PatchLearnerConfig config_;
  patch::OnlineConfig online_;
  int threads_;
  std::atomic<bool> ends_ = false;
  std::mutex mutex_;
  std::unique_ptr<patch::OnlinePatchLearner> made_;  // under mutex_
  std::exception_ptr error_;                         // under mutex_
  log::NewestWork<Job> work_;                        // last: it uses the others
};

}  // namespace strata::patch_learner
