// SPDX-License-Identifier: Apache-2.0
/// Logs that cannot be read twice: a pipe, as of `<(zcat log.gz)` or /dev/stdin.
#pragma once

#include <filesystem>

namespace strata::log {

/// Where the content of a file can be read as often as it is needed: the path itself, or, of a
/// pipe, a temporary file with all that came out of it. A pipe is read once in the life of the
/// process, to its end; the file goes with the process. Messages keep the name that was given.
/// Throws InputError for a device (a terminal, /dev/zero), and when the content cannot be put into
/// the temporary folder. What is not there is left to whoever opens it. Thread-safe.
[[nodiscard]] std::filesystem::path readable_path(const std::filesystem::path& path);

/// Throws InputError when nothing is at the path, or the way to it cannot be gone, with the reason.
void require_reachable(const std::filesystem::path& path);

/// Whether readable_path names another place than `path`, one without a name in any folder.
[[nodiscard]] bool is_pipe(const std::filesystem::path& path);

}  // namespace strata::log
