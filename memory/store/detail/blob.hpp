// SPDX-License-Identifier: Apache-2.0
/// Compressed byte blobs with a checksum, and grids as planes of bytes.
///
/// Numbers are little-endian IEEE 754, which every platform we build for has.
#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace strata::memory::detail {

static_assert(std::endian::native == std::endian::little, "the store keeps little-endian numbers");

/// zstd frame with its content checksum on, so that a flipped bit is found when reading.
[[nodiscard]] std::vector<std::byte> compress(std::span<const std::byte> bytes);
/// The same at a level of zstd's own, 1 to 19.
[[nodiscard]] std::vector<std::byte> compress(std::span<const std::byte> bytes, int level);

/// The same of content that comes in pieces and is never held as a whole. O(piece) memory beside
/// the frame and a window of a few megabytes.
class Compressor {
 public:
  /// content_bytes: of all pieces together, which the frame states.
  explicit Compressor(std::size_t content_bytes);
  ~Compressor();
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;
  void add(std::span<const std::byte> piece);
  /// The whole frame. Requires that content_bytes were added.
  [[nodiscard]] std::vector<std::byte> finish();

 private:
  struct Stream;
  std::unique_ptr<Stream> stream_;
};

/// Throws InputError{place} when the blob is damaged or its content is not expected_size long.
[[nodiscard]] std::vector<std::byte> decompress(std::span<const std::byte> blob,
                                                std::size_t expected_size,
                                                const std::string& place);
/// ... of whatever length the frame states.
[[nodiscard]] std::vector<std::byte> decompress(std::span<const std::byte> blob,
                                                const std::string& place);

/// The values regrouped by byte place: all first bytes, all second bytes, ... which compresses
/// floating-point numbers better than the plain order.
template <typename T>
[[nodiscard]] std::vector<std::byte> to_planes(std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::vector<std::byte> planes(values.size() * sizeof(T));
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::byte raw[sizeof(T)];
    std::memcpy(raw, &values[i], sizeof(T));
    for (std::size_t b = 0; b < sizeof(T); ++b) planes[b * values.size() + i] = raw[b];
  }
  return planes;
}

/// Undoes to_planes. Requires planes.size() == values.size() * sizeof(T).
template <typename T>
void from_planes(std::span<const std::byte> planes, std::span<T> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::byte raw[sizeof(T)];
    for (std::size_t b = 0; b < sizeof(T); ++b) raw[b] = planes[b * values.size() + i];
    std::memcpy(&values[i], raw, sizeof(T));
  }
}

}  // namespace strata::memory::detail
