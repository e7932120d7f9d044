// SPDX-License-Identifier: Apache-2.0
/// Files that appear whole or not at all.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "components/log/disk.hpp"

namespace strata::log {

/// Write to `stream()`, then `commit()`: the file is written aside, synced and renamed into place,
/// so that a power cut, too, leaves the old content or the new one. Without commit nothing is left.
/// In a folder that is itself written aside the folder's commit syncs. Throws OutputError.
class WholeFile {
 public:
  explicit WholeFile(std::filesystem::path path, const Disk& disk = real_disk());
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  [[nodiscard]] std::ofstream& stream() { return stream_; }
  void commit();

 private:
  [[noreturn]] void throw_not_written() const;
  const Disk& disk_;
  std::filesystem::path path_;
  std::filesystem::path aside_;
  std::ofstream stream_;
  bool committed_ = false;
};

/// All of it at once, as WholeFile.
void write_whole_file(const std::filesystem::path& path, const std::string& bytes);
/// Throws InputError when it is missing, a folder, or cannot be read.
[[nodiscard]] std::string read_whole_file(const std::filesystem::path& path);

}  // namespace strata::log
