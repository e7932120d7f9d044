// SPDX-License-Identifier: Apache-2.0
/// Whoever localizes in a comparison, and every run of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "components/maps/map_model.hpp"
#include "core/base/parallel.hpp"
#include "core/base/progress.hpp"
#include "tools/pipeline/compare.hpp"
#include "tools/pipeline/learned_maps.hpp"
#include "tools/pipeline/test_part.hpp"

namespace strata::pipeline {

/// Progress that several threads report to.
class SharedProgress : public Progress {
 public:
  SharedProgress(Progress* progress, std::string stage, std::size_t total)
      : progress_(progress), stage_(std::move(stage)), total_(total) {}
  void one_done() {
    const std::lock_guard lock(mutex_);
    report_progress(progress_, stage_, ++done_, total_);
  }
  /// What comes between two runs, such as learning, moves the count no further.
  void update(std::string_view /*stage*/, std::size_t /*done*/, std::size_t /*total*/) override {
    const std::lock_guard lock(mutex_);
    if (progress_ != nullptr) progress_->update(stage_, done_, total_);
  }
  [[nodiscard]] bool cancelled() const override {
    return progress_ != nullptr && progress_->cancelled();
  }

 private:
  Progress* progress_;
  std::string stage_;
  std::size_t total_;
  std::mutex mutex_;
  std::size_t done_ = 0;
};

/// The models that the configuration names.
[[nodiscard]] std::vector<maps::MapModel> make_models(const maps::Maps& maps,
                                                      const CompareConfig& config,
                                                      const CompareJob& job);

/// The library itself, in this process.
[[nodiscard]] LocalizationRun localize_here(const LocalizeJob& job);

/// One of our models, or a peer.
struct Candidate {
  std::size_t map_bytes = 0;
  std::size_t resident_bytes = 0;
  std::function<LocalizationRun(std::uint64_t seed)> localize;
};

/// The models, then the peers. Refers to what is given, which must stay.
[[nodiscard]] std::vector<Candidate> make_candidates(const std::vector<maps::MapModel>& models,
                                                     const LocalizeFunction& localize_one,
                                                     const std::vector<Peer>& peers,
                                                     const Learned& learned,
                                                     const CompareConfig& config,
                                                     const TestPart& part);

/// Every seed of every candidate in one part, added to `results`, one a candidate. One run a
/// thread: the runs depend neither on each other nor on how many go at once.
void run_candidates(const std::vector<Candidate>& candidates, const TestPart& part,
                    std::size_t part_index, std::span<const std::uint64_t> seeds, WorkerPool& pool,
                    SharedProgress& progress, std::vector<ModelResult>& results);

}  // namespace strata::pipeline
