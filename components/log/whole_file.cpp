// SPDX-License-Identifier: Apache-2.0
#include "components/log/whole_file.hpp"

#include <sstream>
#include <system_error>
#include <utility>

#include "core/base/error.hpp"

namespace strata::log {

WholeFile::WholeFile(std::filesystem::path path, const Disk& disk)
    : disk_(disk),
      path_(std::move(path)),
      aside_(staged_name(path_)),
      stream_(aside_, std::ios::binary | std::ios::trunc) {
  remove_left_over(path_);
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
  if (!stream_) throw_not_written();
  try {
    if (is_staged(path_)) {
      disk_.rename(aside_, path_);
    } else {
      put_in_place(disk_, aside_, path_);
    }
  } catch (const OutputError&) {
    throw_not_written();
  }
  committed_ = true;
}

void WholeFile::throw_not_written() const {
  throw OutputError(path_.string(), "cannot be written to its end", "free some space");
}

void write_whole_file(const std::filesystem::path& path, const std::string& bytes) {
  WholeFile file(path);
  file.stream() << bytes;
  file.commit();
}

std::string read_whole_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream bytes;
  if (in) bytes << in.rdbuf();
  if (!in || std::filesystem::is_directory(path)) {
    throw InputError(path.string(), "cannot be read", "check the file and its permissions");
  }
  return std::move(bytes).str();
}

}  // namespace strata::log
