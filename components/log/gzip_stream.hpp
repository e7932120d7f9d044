// SPDX-License-Identifier: Apache-2.0
/// A stream that packs what is written to it with gzip.
#pragma once

#include <array>
#include <memory>
#include <ostream>
#include <streambuf>

namespace strata::log {

/// Takes bytes, and puts them packed into another stream, which must outlive it.
class GzipBuffer final : public std::streambuf {
 public:
  explicit GzipBuffer(std::ostream& packed);
  ~GzipBuffer() override;
  GzipBuffer(const GzipBuffer&) = delete;
  GzipBuffer& operator=(const GzipBuffer&) = delete;
  /// Ends the gzip file; nothing is to be written afterwards. What fails shows in the other stream.
  void finish();

 private:
  struct Deflater;
  int_type overflow(int_type character) override;
  void pack(bool is_end);
  std::ostream& packed_;
  std::unique_ptr<Deflater> deflater_;
  std::array<char, 1U << 16U> plain_;
};

}  // namespace strata::log
