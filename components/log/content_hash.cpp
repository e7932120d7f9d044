// SPDX-License-Identifier: Apache-2.0
#include "components/log/content_hash.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <system_error>
#include <utility>

#include "components/log/sha256.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

constexpr std::size_t kShortDigits = 12;

bool counts(const std::string& name) {
  return !name.starts_with(".") && !name.ends_with("-wal") && !name.ends_with("-shm");
}

[[noreturn]] void throw_unreadable(const fs::path& path, const std::string& why) {
  throw InputError(path.string(), "cannot be read: " + why,
                   "check its permissions, and that nothing replaces it meanwhile");
}

/// Paths below `folder`, in any order.
std::vector<std::string> names_in(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw InputError(folder.string(), "is no folder", "name one, as `strata learn` writes it");
  }
  std::vector<std::string> names;
  fs::recursive_directory_iterator entry(folder, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    if (!counts(entry->path().filename().string())) {
      entry.disable_recursion_pending();
      continue;
    }
    std::error_code ignored;
    if (entry->is_regular_file(ignored)) {
      names.push_back(entry->path().lexically_relative(folder).generic_string());
    }
  }
  if (error) throw_unreadable(folder, error.message());
  return names;
}

}  // namespace

std::uint64_t HashedContent::bytes() const {
  std::uint64_t sum = 0;
  for (const HashedFile& file : files) sum += file.bytes;
  return sum;
}

HashedFile hash_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw_unreadable(path, std::generic_category().message(errno));
  HashedFile file{path.filename().string(), "", 0};
  Sha256 digest;
  std::array<char, 65536> buffer{};
  while (in.read(buffer.data(), buffer.size()) || in.gcount() > 0) {
    digest.add(buffer.data(), static_cast<std::size_t>(in.gcount()));
    file.bytes += static_cast<std::uint64_t>(in.gcount());
  }
  if (in.bad()) throw_unreadable(path, "the disk gives an error");
  file.sha256 = digest.hex();
  return file;
}

std::string hash_of(std::vector<HashedFile>& files) {
  std::sort(files.begin(), files.end(),
            [](const HashedFile& a, const HashedFile& b) { return a.path < b.path; });
  Sha256 digest;
  for (const HashedFile& file : files) {
    digest.add(file.sha256);
    digest.add("  ");
    digest.add(file.path);
    digest.add("\n");
  }
  return digest.hex();
}

HashedContent hash_content(const fs::path& folder) {
  HashedContent content;
  for (const std::string& name : names_in(folder)) {
    HashedFile file = hash_file(folder / name);
    file.path = name;
    content.files.push_back(std::move(file));
  }
  content.hash = hash_of(content.files);
  return content;
}

std::string short_hash(const std::string& hash) { return hash.substr(0, kShortDigits); }

std::string content_digest(const fs::path& path) {
  return fs::is_directory(path) ? hash_content(path).hash : hash_file(path).sha256;
}

}  // namespace strata::log
