// SPDX-License-Identifier: Apache-2.0
/// Files read and written whole.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include "components/log/whole_file.hpp"
#include "core/base/error.hpp"

namespace strata::volume_mapper {

/// Throws InputError.
inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream bytes;
  if (in) bytes << in.rdbuf();
  if (!in || in.bad() || std::filesystem::is_directory(file)) {
    throw InputError(file.string(), "cannot be read", "check the file and its permissions");
  }
  return std::move(bytes).str();
}

/// All or nothing. Throws OutputError.
inline void write_whole(const std::filesystem::path& path, const std::string& bytes) {
  log::WholeFile file(path);
  file.stream() << bytes;
  file.commit();
}

}  // namespace strata::volume_mapper
