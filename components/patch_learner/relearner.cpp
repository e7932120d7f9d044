// SPDX-License-Identifier: Apache-2.0
#include "components/patch_learner/relearner.hpp"

#include <optional>
#include <utility>

namespace strata::patch_learner {

Relearner::Relearner(patch::PatchLearnerConfig config, patch::OnlineConfig online, int threads)
    : config_(std::move(config)),
      online_(online),
      threads_(threads),
      work_([this](Job job) { work_on(std::move(job)); }) {}

Relearner::~Relearner() {
  work_.drop();
  ends_ = true;
}

void Relearner::begin(std::vector<PosedScan> scans, ReflectionGrid base) {
  work_.put([&](std::optional<Job>& waiting) {
    waiting.emplace(Job{std::move(scans), std::move(base)});
  });
}

std::unique_ptr<patch::OnlinePatchLearner> Relearner::take() {
  const std::lock_guard lock(mutex_);
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  return std::move(made_);
}

void Relearner::work_on(Job job) {
  std::unique_ptr<patch::OnlinePatchLearner> learner;
  std::exception_ptr error;
  try {
    learner = std::make_unique<patch::OnlinePatchLearner>(config_, online_, std::move(job.base),
                                                          threads_);
    for (PosedScan& scan : job.scans) {
      if (ends_) return;
      (void)learner->add(std::move(scan));
    }
  } catch (...) {  // too little memory
    learner.reset();
    error = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  made_ = std::move(learner);
  error_ = std::move(error);
}

}  // namespace strata::patch_learner
