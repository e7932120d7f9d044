// SPDX-License-Identifier: Apache-2.0
#include "components/topology_mapper/mapper_store.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/base/error.hpp"

namespace strata::topology_mapper {
namespace {

constexpr const char* kMarks = "topology/marks";
constexpr const char* kOdometry = "topology/odometry";

/// Nothing when it is not there, or null.
template <typename T>
std::optional<T> read(const memory::Store& store, const char* key) {
  const std::optional<std::string> text = store.find_text(key);
  if (!text) return std::nullopt;
  try {
    const nlohmann::json value = nlohmann::json::parse(*text);
    return value.is_null() ? std::nullopt : std::optional(value.get<T>());
  } catch (const nlohmann::json::exception&) {
    throw InputError(store.path().string(), std::string("has a damaged ") + key,
                     "take it from a backup, or remove it to begin anew");
  }
}

}  // namespace

MapperStore::MapperStore(const std::filesystem::path& file) : store_(file) {}

std::optional<MapperStore::Restored> MapperStore::restore(topology::TopologyMapper& mapper) {
  std::optional<Restored> restored;
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
      restored = Restored{scan.scan.stamp, std::nullopt};
    }
  }
  for (; mark != marks_.cend(); ++mark) mapper.mark(mark->stamp);
  if (!restored) return restored;
  if (const auto pose = read<std::array<double, 3>>(store_, kOdometry)) {
    restored->odom_from_robot = Pose2{(*pose)[0], (*pose)[1], (*pose)[2]};
  }
  return restored;
}

void MapperStore::mark(Stamp stamp) {
  marks_.push_back({scans_, stamp});
  has_new_mark_ = true;
}

void MapperStore::add(const PosedScan& tracked, const std::optional<Pose2>& odom_from_robot) {
  waiting_.push_back(tracked);
  odom_from_robot_ = odom_from_robot;
  ++scans_;
}

void MapperStore::flush() {
  if (waiting_.empty() && !has_new_mark_) return;
  store_.transaction([&] {
    if (!waiting_.empty()) {
      store_.append_scans(waiting_.front().run, waiting_);
      nlohmann::json odometry;
      if (odom_from_robot_) {
        odometry = {odom_from_robot_->x, odom_from_robot_->y, odom_from_robot_->theta};
      }
      store_.save_text(kOdometry, odometry.dump());
    }
    if (has_new_mark_) {
      nlohmann::json marks = nlohmann::json::array();
      for (const Mark& mark : marks_) marks.push_back({mark.after_scans, mark.stamp.ns});
      store_.save_text(kMarks, marks.dump());
    }
  });
  waiting_.clear();
  has_new_mark_ = false;
}

}  // namespace strata::topology_mapper
