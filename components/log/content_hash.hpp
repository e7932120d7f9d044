// SPDX-License-Identifier: Apache-2.0
/// The hash of a folder by what is in it, whoever copied it, when and where: of a MAPS folder it is
/// the map's hash.
///
/// It is the SHA-256 of a list with a line a file, "SHA256  PATH", as `sha256sum` writes it, sorted
/// by the bytes of the paths, so that anybody can check it (docs/site.md has the command). Names
/// that begin with a dot, and what SQLite keeps beside an open database (-wal, -shm), are no part
/// of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace strata::log {

struct HashedFile {
  std::string path;    ///< below the folder, with slashes
  std::string sha256;  ///< 64 digits
  std::uint64_t bytes = 0;
  friend bool operator==(const HashedFile&, const HashedFile&) = default;
};

struct HashedContent {
  std::string hash;               ///< 64 digits
  std::vector<HashedFile> files;  ///< sorted by path
  [[nodiscard]] std::uint64_t bytes() const;
};

/// Reads every file of the folder; links to files count as what they lead to. Throws InputError
/// where there is no folder, or something in it cannot be read, also because it went meanwhile.
/// O(bytes), about a second for a gigabyte.
[[nodiscard]] HashedContent hash_content(const std::filesystem::path& folder);

/// The SHA-256 of one file's content. Throws InputError.
[[nodiscard]] HashedFile hash_file(const std::filesystem::path& file);

/// The hash of a folder's content, or of a file's. Throws InputError.
[[nodiscard]] std::string content_digest(const std::filesystem::path& path);

/// The hash of a list of files, which is sorted first.
[[nodiscard]] std::string hash_of(std::vector<HashedFile>& files);

/// The digits that are enough for people to tell one hash from another.
[[nodiscard]] std::string short_hash(const std::string& hash);

}  // namespace strata::log
