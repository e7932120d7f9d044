// SPDX-License-Identifier: Apache-2.0
/// Hand-verified relative poses [kummerle2009measuring].
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/time.hpp"
#include "core/geometry/pose2.hpp"

namespace strata::log {

struct Relation {
  Stamp first;
  Stamp second;
  Pose2 first_from_second;
};

/// Rows `t1 t2 x y z roll pitch yaw`. Throws InputError(file:line) for any other row and for a file
/// without one.
[[nodiscard]] std::vector<Relation> read_relations(const std::filesystem::path& path);

}  // namespace strata::log
