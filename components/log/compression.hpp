// SPDX-License-Identifier: Apache-2.0
/// zstd and lz4 frames: chunks of MCAP, and the messages and files that rosbag2 compresses.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "components/log/bag.hpp"

namespace strata::log {

using Bytes = std::vector<std::uint8_t>;
using View = std::span<const std::uint8_t>;

/// "", "zstd" or "lz4", as MCAP and metadata.yaml name them.
[[nodiscard]] std::string_view compression_name(BagCompression compression);
/// Told by the frame's first bytes; kNone for anything else.
[[nodiscard]] BagCompression compression_of(View bytes);
[[nodiscard]] BagCompression compression_of_file(const std::filesystem::path& file);

[[nodiscard]] Bytes compress(View plain, BagCompression compression);

/// Unpacks one frame (kNone copies). Memory grows with what really comes out, to `limit` at most: a
/// damaged length takes none. `error` is empty, or says why what came out ends early.
[[nodiscard]] Bytes decompress(View packed, BagCompression compression, std::uint64_t limit,
                               std::string& error);

/// The content of a compressed file, or of a pipe, in a temporary file, which goes with the object;
/// what was opened before stays readable. The file is locked: one that nobody holds is of a process
/// that was killed, and the next object takes it away.
class UnpackedFile {
 public:
  /// Throws InputError when the file cannot be read, or its content put into the temporary folder.
  explicit UnpackedFile(const std::filesystem::path& file);
  ~UnpackedFile();
  UnpackedFile(const UnpackedFile&) = delete;
  UnpackedFile& operator=(const UnpackedFile&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Why the content ends early; empty when it is whole.
  [[nodiscard]] const std::string& damage() const { return damage_; }

 private:
  void remove() const;

  int lock_ = -1;  ///< of the open file; -1: none could be made
  std::filesystem::path path_;
  std::string damage_;
};

/// Writes `file` as one zstd frame to `packed`. Throws OutputError.
void pack_file(const std::filesystem::path& file, const std::filesystem::path& packed);

}  // namespace strata::log
