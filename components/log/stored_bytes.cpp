// SPDX-License-Identifier: Apache-2.0
#include "components/log/stored_bytes.hpp"

#include <exception>
#include <system_error>

namespace strata::log {
namespace {

namespace fs = std::filesystem;

std::uint64_t bytes_of(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  return error ? 0 : size;
}

}  // namespace

std::uint64_t stored_bytes(const fs::path& store) noexcept {
  try {
    std::error_code error;
    if (!fs::is_directory(store, error)) {
      return bytes_of(store) + bytes_of(store.string() + "-wal") +
             bytes_of(store.string() + "-shm");
    }
    std::uint64_t sum = 0;
    for (fs::recursive_directory_iterator at(store, error), end; !error && at != end;
         at.increment(error)) {
      std::error_code asked;
      if (at->is_regular_file(asked)) sum += bytes_of(at->path());
    }
    return sum;
  } catch (const std::exception&) {
    return 0;
  }
}

}  // namespace strata::log
