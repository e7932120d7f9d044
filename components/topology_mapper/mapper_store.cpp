// SPDX-License-Identifier: Apache-2.0
#include "components/topology_mapper/mapper_store.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/base/damage.hpp"
#include "memory/store/store_summary.hpp"

namespace strata::topology_mapper {
namespace {

constexpr const char* kMarks = "topology/marks";
constexpr const char* kNewest = "topology/newest";
/// Of versions that kept every scan: the newest one's.
constexpr const char* kOldOdometry = "topology/odometry";

/// Nothing when it is not there, or null.
template <typename T>
std::optional<T> read(const memory::Store& store, const char* key) {
  const std::optional<std::string> text = store.find_text(key);
  if (!text) return std::nullopt;
  try {
    const nlohmann::json value = nlohmann::json::parse(*text);
    return value.is_null() ? std::nullopt : std::optional(value.get<T>());
  } catch (const nlohmann::json::exception&) {
    throw DamageError(store.path().string(), std::string("has a damaged ") + key,
                      "take it from a backup, or remove it to begin anew");
  }
}

/// A moment's stamp; its pose, and that of its odometry if it has one.
using SavedMoment = std::pair<std::int64_t, std::vector<std::array<double, 3>>>;

SavedMoment to_saved(const topology::TrackedMoment& moment) {
  const auto values = [](const Pose2& pose) { return std::array{pose.x, pose.y, pose.theta}; };
  SavedMoment kept{moment.stamp.ns, {values(moment.map_from_robot)}};
  if (moment.odom_from_robot) kept.second.push_back(values(*moment.odom_from_robot));
  return kept;
}

topology::TrackedMoment from_saved(const SavedMoment& kept) {
  const auto pose = [](const std::array<double, 3>& values) {
    return Pose2{values[0], values[1], values[2]};
  };
  topology::TrackedMoment moment{Stamp{kept.first}, pose(kept.second.front()), std::nullopt};
  if (kept.second.size() > 1) moment.odom_from_robot = pose(kept.second[1]);
  return moment;
}

}  // namespace

void require_way(const std::filesystem::path& file) {
  if (!memory::is_store(file)) return;
  memory::StoreSummary summary;
  try {
    summary = memory::summarize_store(file);
  } catch (const InputError&) {
    return;
  }
  const bool has_maps = !summary.grids.empty() || !summary.patch_maps.empty();
  if (!has_maps && summary.timescales.empty()) return;
  throw ConfigError(file.string(),
                    std::string("is another file than store.file may name: this is the store of ") +
                        (has_maps ? "learned maps" : "a timescale memory") +
                        "; it is to be a topology mapper's own",
                    "name another file in store.file; this one was left as it is");
}

MapperStore::MapperStore(const std::filesystem::path& file) : store_(file) {}

std::optional<topology::TrackedMoment> MapperStore::restore(topology::TopologyMapper& mapper) {
  try {
    return restore_all(mapper);
  } catch (const DamageError&) {
    store_.leave_as_is();
    throw;
  }
}

std::optional<topology::TrackedMoment> MapperStore::restore_all(topology::TopologyMapper& mapper) {
  using Marks = std::vector<std::pair<std::size_t, std::int64_t>>;
  for (const auto& [after_scans, stamp_ns] : read<Marks>(store_, kMarks).value_or(Marks())) {
    marks_.push_back({after_scans, Stamp{stamp_ns}});
  }
  auto mark = marks_.cbegin();
  for (const int run : store_.runs_with_scans()) {
    for (const PosedScan& scan : store_.load_scans(run)) {
      for (; mark != marks_.cend() && mark->after_scans <= scans_; ++mark) mapper.mark(mark->stamp);
      for (topology::MadeVisit& visit : mapper.restore(scan)) (void)mapper.update(std::move(visit));
      ++scans_;
    }
  }
  for (; mark != marks_.cend(); ++mark) mapper.mark(mark->stamp);
  if (scans_ == 0) return std::nullopt;
  newest_ = mapper.newest();
  const auto kept = read<SavedMoment>(store_, kNewest);
  // Without it, of an older version: where the last scan was taken, whose odometry that one wrote.
  if (kept && !kept->second.empty() && kept->first >= newest_->stamp.ns) {
    newest_ = from_saved(*kept);
  } else if (const auto odom = read<std::array<double, 3>>(store_, kOldOdometry); odom && !kept) {
    newest_->odom_from_robot = Pose2{(*odom)[0], (*odom)[1], (*odom)[2]};
  }
  return newest_;
}

void MapperStore::mark(Stamp stamp) {
  marks_.push_back({scans_, stamp});
  has_new_mark_ = true;
}

void MapperStore::add(const PosedScan& kept) {
  waiting_.push_back(kept);
  ++scans_;
}

void MapperStore::came_to(const topology::TrackedMoment& newest) {
  has_moved_on_ = has_moved_on_ || !newest_ || newest_->stamp < newest.stamp;
  newest_ = newest;
}

void MapperStore::flush() {
  if (waiting_.empty() && !has_new_mark_ && !has_moved_on_) return;
  store_.transaction([&] {
    if (!waiting_.empty()) store_.append_scans(waiting_.front().run, waiting_);
    if (has_new_mark_) {
      nlohmann::json marks = nlohmann::json::array();
      for (const Mark& mark : marks_) marks.push_back({mark.after_scans, mark.stamp.ns});
      store_.save_text(kMarks, marks.dump());
    }
    if (has_moved_on_) store_.save_text(kNewest, nlohmann::json(to_saved(*newest_)).dump());
  });
  waiting_.clear();
  has_new_mark_ = false;
  has_moved_on_ = false;
}

}  // namespace strata::topology_mapper
