// SPDX-License-Identifier: Apache-2.0
#include "components/scan_matcher/maps_saver.hpp"

#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <system_error>
#include <utility>

#include <sys/resource.h>
#include <time.h>

#include "components/convert/patch_messages.hpp"
#include "components/log/disk.hpp"
#include "components/log/folder_name.hpp"
#include "components/log/whole_folder.hpp"
#include "components/maps/earlier_runs.hpp"
#include "components/scan_matcher/damaged_maps.hpp"
#include "core/base/error.hpp"
#include "core/patch/learn_again.hpp"

namespace fs = std::filesystem;

namespace strata::scan_matcher {
namespace {

/// Of this thread.
double cpu_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double peak_rss_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// Whether none that was accepted is forgotten, and each has its place in the map. O(what is kept).
bool has_all_scans(const slam::Slam& slam) {
  std::size_t next = 0;
  bool has_all = true;
  slam.visit_kept([&](const slam::Slam::Mapped& scan) {
    has_all = has_all && scan.number == next;
    ++next;
  });
  return has_all && next == slam.kept_scans();
}

}  // namespace

/// Cancels what a saver that goes is doing.
class MapsSaver::UntilItEnds : public Progress {
 public:
  explicit UntilItEnds(const std::atomic<bool>& ends) : ends_(ends) {}
  void update(std::string_view /*stage*/, std::size_t /*done*/, std::size_t /*total*/) override {}
  [[nodiscard]] bool cancelled() const override { return ends_; }

 private:
  const std::atomic<bool>& ends_;
};

void require_replaceable(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) return;
  if (fs::is_directory(folder, error) && fs::is_empty(folder, error)) return;
  if (!fs::exists(folder / maps::kStoreFile, error)) {
    throw OutputError(folder.string(), "holds something else than maps, which saving would replace",
                      "name another maps.folder");
  }
  const std::string log = maps::log_of(folder);
  if (log == kLiveLog) return;
  throw OutputError(folder.string(),
                    log.empty()
                        ? "holds maps without a summary, of which nobody knows whose they are"
                        : "holds maps of '" + log + "', which saving would replace",
                    "name another maps.folder, or localize in them and go on learning "
                    "(online.yaml)");
}

MapsSaver::MapsSaver(const fs::path& folder, SaverConfig config)
    : folder_(log::without_slash(fs::weakly_canonical(fs::absolute(folder)))),
      config_(std::move(config)),
      work_([this](const Job& job) { work_on(job); }) {
  log::put_back(log::real_disk(), folder_);
  log::remove_left_over(folder_);  // of savers whose process was killed
  require_replaceable(folder_);
}

bool MapsSaver::has_maps() const {
  std::error_code error;
  return fs::exists(folder_ / maps::kStoreFile, error);
}

MapsSaver::~MapsSaver() {
  work_.drop();
  ends_ = true;
}

void MapsSaver::save(Snapshot snapshot, Done done) {
  work_.put([&](std::optional<Job>& waiting) {
    if (!waiting) waiting.emplace();
    waiting->snapshot = std::move(snapshot);
    if (done) waiting->done.push_back(std::move(done));
  });
}

void MapsSaver::check() {
  std::string error;
  {
    const std::lock_guard lock(mutex_);
    error = std::exchange(error_, {});
  }
  if (error.empty()) return;
  throw OutputError(folder_.string(), "the maps could not be saved: " + error,
                    "make room or name another maps.folder; it is tried again as the map grows");
}

void MapsSaver::flush() {
  work_.wait();
  check();
}

void MapsSaver::work_on(const Job& job) {
  const auto begin = std::chrono::steady_clock::now();
  std::string error;
  try {
    write(job.snapshot);
  } catch (const std::exception& reason) {
    error = reason.what();
  }
  last_s_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (const Done& tell : job.done) {
    try {
      tell(error);
    } catch (const std::exception&) {  // too little memory to answer
    }
  }
  const std::lock_guard lock(mutex_);
  error_ = std::move(error);
}

/// Counts what stays as it was.
patch::PatchMap MapsSaver::learned_again(const patch::PatchMap& known,
                                         const slam::SlamResult& result, Progress& progress) {
  patch::LearnedAgain again =
      patch::learn_again(known, result.scans, result.filtered, config_.patch, &progress);
  live_submaps_ = again.stayed;
  return std::move(again.map);
}

void MapsSaver::write(const Snapshot& snapshot) {
  const auto begin = std::chrono::steady_clock::now();
  const double cpu_before_s = cpu_s();
  require_replaceable(folder_);
  log::WholeFolder folder(folder_, log::real_disk(), log::WholeFolder::Existing::kReplace);
  UntilItEnds progress(ends_);
  slam::Slam copy(config_.slam, 1, config_.keep);  // the mapper comes first
  copy.restore_state(snapshot.slam, "the running mapper");
  const bool is_whole = has_all_scans(copy);
  const slam::SlamResult result = copy.finish(&progress);
  maps::write_grid_maps(folder.aside(), result);
  if (snapshot.patches) {
    patch::PatchMap patches = convert::from_message(*snapshot.patches);
    if (is_whole) {
      patches = learned_again(patches, result, progress);
    } else {
      live_submaps_ = patches.submaps.size();
      patches.base = patch::filled(result.filtered, patches.base);
    }
    maps::write_patch_map(folder.aside(), patches);
  }
  maps::JobCost cost;
  cost.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  cost.cpu_s = cpu_s() - cpu_before_s;
  cost.peak_rss_mb = peak_rss_mb();
  (void)maps::write_summary(folder.aside(), kLiveLog, cost);
  require_replaceable(folder_);
  folder.commit();
}

}  // namespace strata::scan_matcher
