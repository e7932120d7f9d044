// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/output_directory.hpp"

#include <string>
#include <system_error>
#include <utility>

#include <unistd.h>

#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::tools {

void StagedPaths::add(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  paths_.insert(path);
}

void StagedPaths::forget(const fs::path& path) {
  const std::lock_guard lock(mutex_);
  paths_.erase(path);
}

void StagedPaths::put_in_place(const fs::path& path, const std::function<void()>& put) {
  const std::lock_guard lock(mutex_);
  put();
  paths_.erase(path);
}

void StagedPaths::remove_all() noexcept {
  const std::lock_guard lock(mutex_);
  std::error_code ignored;
  for (const fs::path& path : paths_) fs::remove_all(path, ignored);
  paths_.clear();
}

OutputDirectory::OutputDirectory(fs::path target, StagedPaths& staged)
    : target_(std::move(target)), staged_(staged) {
  if (target_.empty()) throw OutputError("--out", "is empty", "name a folder");
  if (!target_.has_filename()) target_ = target_.parent_path();
  if (fs::exists(target_) && !fs::is_directory(target_)) {
    throw OutputError(target_.string(), "exists and is not a folder", "choose another --out");
  }
  // "." and ".." have no usable name of their own to stand beside.
  const fs::path whole = fs::weakly_canonical(fs::absolute(target_));
  path_ = whole.parent_path() /
          ("." + whole.filename().string() + ".partial-" + std::to_string(getpid()));
  staged_.add(path_);
  std::error_code error;
  fs::remove_all(path_, error);
  fs::create_directories(path_, error);
  if (error) {
    staged_.forget(path_);
    throw OutputError(target_.string(), "cannot be written: " + error.message(),
                      "choose another --out or mend its permissions");
  }
}

OutputDirectory::~OutputDirectory() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  staged_.forget(path_);
}

void OutputDirectory::commit() {
  staged_.put_in_place(path_, [this] { put_in_place(); });
  committed_ = true;
}

void OutputDirectory::put_in_place() const {
  std::error_code error;
  if (!fs::exists(target_)) {
    fs::rename(path_, target_, error);
  } else {
    for (const auto& entry : fs::directory_iterator(path_)) {
      const fs::path to = target_ / entry.path().filename();
      if (fs::is_directory(to)) fs::remove_all(to, error);
      if (!error) fs::rename(entry.path(), to, error);
      if (error) break;
    }
    if (!error) fs::remove_all(path_, error);
  }
  if (error) {
    throw OutputError(target_.string(), "cannot be put in place: " + error.message(),
                      "choose another --out or mend its permissions");
  }
}

}  // namespace strata::tools
