// SPDX-License-Identifier: Apache-2.0
#include "components/log/whole_file.hpp"

#include <string>
#include <system_error>
#include <utility>

#include <unistd.h>

#include "core/base/error.hpp"

namespace strata::log {

WholeFile::WholeFile(std::filesystem::path path)
    : path_(std::move(path)),
      aside_(path_.parent_path() /
             ("." + path_.filename().string() + ".partial-" + std::to_string(getpid()))),
      stream_(aside_, std::ios::binary | std::ios::trunc) {
  if (!stream_) {
    throw OutputError(path_.string(), "cannot be written",
                      "check that its folder exists and may be written");
  }
}

WholeFile::~WholeFile() {
  if (committed_) return;
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(aside_, ignored);
}

void WholeFile::commit() {
  stream_.close();
  std::error_code error;
  if (stream_) std::filesystem::rename(aside_, path_, error);
  if (!stream_ || error) {
    throw OutputError(path_.string(), "cannot be written to its end", "free some space");
  }
  committed_ = true;
}

}  // namespace strata::log
