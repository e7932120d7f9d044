// SPDX-License-Identifier: Apache-2.0
#include "components/log/writable_place.hpp"

#include <string>

#include <unistd.h>

#include "core/base/error.hpp"

namespace strata::log {
namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

/// `folder`, or the nearest above it that is there; of a file in the way, the file.
fs::path nearest_that_exists(fs::path folder) {
  while (!is_there(folder) && folder.has_parent_path() && folder != folder.parent_path()) {
    folder = folder.parent_path();
  }
  return folder;
}

}  // namespace

void require_folder_place(const fs::path& folder) {
  const fs::path above = nearest_that_exists(fs::absolute(folder));
  if (!is_folder(above)) {
    throw OutputError(folder.string(), above.string() + " is no folder", "choose another place");
  }
  if (access(above.c_str(), W_OK | X_OK) != 0) {
    throw OutputError(folder.string(), "nothing can be written in " + above.string(),
                      "choose another place, or change its permissions");
  }
}

void require_file_place(const fs::path& file) {
  if (is_folder(file)) {
    throw OutputError(file.string(), "is a folder", "name a file in it");
  }
  if (is_there(file) && access(file.c_str(), W_OK) != 0) {
    throw OutputError(file.string(), "cannot be written",
                      "choose another place, or change its permissions");
  }
  require_folder_place(fs::absolute(file).parent_path());
}

}  // namespace strata::log
