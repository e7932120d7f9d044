// SPDX-License-Identifier: Apache-2.0
/// What a component kept and cannot read any more is set aside: the component goes on without it,
/// and nothing is lost that somebody may still want to look into.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "components/log/disk.hpp"
#include "core/base/damage.hpp"

namespace strata::log {

/// Gives the file the name NAME.damaged, or NAME.damaged-2 and so on where that is taken, and what
/// SQLite keeps beside it a name that goes with it; they are on the disk under these names
/// afterwards. No other program may have it open. Returns the new path. Throws OutputError.
std::filesystem::path set_aside(const std::filesystem::path& file, const Disk& disk = real_disk());

/// What is told of a map or memory that was set aside since it is not of the frame that poses come
/// in (FrameWatch).
[[nodiscard]] InputError other_frame(const std::filesystem::path& file,
                                     const std::filesystem::path& aside);

/// Whether a file was set aside by set_aside, or belongs to one that was.
[[nodiscard]] bool is_set_aside(const std::filesystem::path& path);

/// Runs `restore`, which reads the file. When that is empty, or `restore` throws DamageError or
/// UnknownContentError, the file is set aside, and the answer says so, where and why: what
/// `restore` has filled by then is of no use, and whatever has the file open must be closed.
/// Nothing: it was restored. Passes on whatever else is thrown, and throws OutputError when the
/// file cannot be set aside.
[[nodiscard]] std::optional<DamageError> restore_or_set_aside(const std::filesystem::path& file,
                                                              const std::function<void()>& restore,
                                                              const Disk& disk = real_disk());

}  // namespace strata::log
