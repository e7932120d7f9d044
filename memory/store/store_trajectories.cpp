// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstring>

#include "core/base/damage.hpp"
#include "memory/store/detail/store_impl.hpp"

namespace strata::memory {

void Store::save_trajectory(int run, std::span<const TrajectoryPose> poses) {
  transaction([&] {
    detail::Database& database = impl_->database;
    detail::Statement(database, "DELETE FROM pose WHERE run = ?").bind(run).run();
    detail::Statement insert(
        database,
        "INSERT INTO pose (run, place, stamp_ns, x_m, y_m, theta_rad, covariance) "
        "VALUES (?, ?, ?, ?, ?, ?, ?)");
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const Pose2& pose = poses[i].map_from_robot;
      insert.bind(run).bind(static_cast<std::int64_t>(i)).bind(poses[i].stamp.ns);
      insert.bind(pose.x).bind(pose.y).bind(pose.theta);
      if (poses[i].covariance) {
        insert.bind(std::as_bytes(std::span(poses[i].covariance->data(), 9)));
      } else {
        insert.bind_null();
      }
      insert.run();
    }
  });
}

std::vector<TrajectoryPose> Store::load_trajectory(int run) const {
  detail::Statement statement(impl_->database,
                              "SELECT stamp_ns, x_m, y_m, theta_rad, covariance FROM pose "
                              "WHERE run = ? ORDER BY place");
  statement.bind(run);
  std::vector<TrajectoryPose> poses;
  while (statement.step()) {
    TrajectoryPose pose;
    pose.stamp = {statement.integer(0)};
    pose.map_from_robot = {statement.real(1), statement.real(2), statement.real(3)};
    if (!statement.is_null(4)) {
      const std::vector<std::byte> bytes = statement.blob(4);
      if (bytes.size() != 9 * sizeof(double)) {
        throw DamageError(path_.string() + ": trajectory of run " + std::to_string(run),
                          "a covariance is damaged", "take the store from a backup");
      }
      std::memcpy(pose.covariance.emplace().data(), bytes.data(), bytes.size());
    }
    poses.push_back(pose);
  }
  return poses;
}

std::vector<int> Store::runs() const {
  detail::Statement statement(impl_->database, "SELECT DISTINCT run FROM pose ORDER BY run");
  std::vector<int> runs;
  while (statement.step()) runs.push_back(static_cast<int>(statement.integer(0)));
  return runs;
}

}  // namespace strata::memory
