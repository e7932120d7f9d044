// SPDX-License-Identifier: Apache-2.0
/// Files that appear whole or not at all.
#pragma once

#include <filesystem>
#include <fstream>

namespace strata::log {

/// Write to `stream()`, then `commit()`: the file is written aside and renamed into place. Without
/// commit nothing is left. Throws OutputError.
class WholeFile {
 public:
  explicit WholeFile(std::filesystem::path path);
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  [[nodiscard]] std::ofstream& stream() { return stream_; }
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path aside_;
  std::ofstream stream_;
  bool committed_ = false;
};

}  // namespace strata::log
