// SPDX-License-Identifier: Apache-2.0
#include "components/log/bz2.hpp"

#include <algorithm>
#include <limits>
#include <new>

#include <bzlib.h>

namespace strata::log {
namespace {

constexpr std::size_t kFirstBytes = 1 << 20;

class Stream {
 public:
  Stream() {
    if (BZ2_bzDecompressInit(&stream_, 0, 0) != BZ_OK) throw std::bad_alloc();
  }
  ~Stream() { BZ2_bzDecompressEnd(&stream_); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  bz_stream& get() { return stream_; }

 private:
  bz_stream stream_{};
};

}  // namespace

Bytes unpack_bz2(View packed, std::uint64_t limit, std::string& error) {
  error.clear();
  const auto most = static_cast<std::size_t>(limit);
  if (packed.size() > std::numeric_limits<unsigned>::max()) {
    error = "it is too long";
    return {};
  }
  Stream stream;
  bz_stream& state = stream.get();
  // The library only reads what it is given, whatever its pointer says.
  state.next_in = const_cast<char*>(reinterpret_cast<const char*>(packed.data()));
  state.avail_in = static_cast<unsigned>(packed.size());
  Bytes plain(std::min(most, kFirstBytes));
  std::size_t size = 0;
  while (true) {
    const std::size_t room =
        std::min<std::size_t>(plain.size() - size, std::numeric_limits<unsigned>::max());
    state.next_out = reinterpret_cast<char*>(plain.data() + size);
    state.avail_out = static_cast<unsigned>(room);
    const unsigned before = state.avail_in;
    const int code = BZ2_bzDecompress(&state);
    const std::size_t filled = room - state.avail_out;
    size += filled;
    if (code == BZ_STREAM_END) break;
    if (code != BZ_OK) {
      error = code == BZ_MEM_ERROR ? "there is not enough memory" : "its bzip2 data is damaged";
      break;
    }
    if (size == plain.size() && size < most) {
      plain.resize(std::min(most, 2 * plain.size()));
    } else if (filled == 0 && state.avail_in == before) {
      error = size == most && state.avail_in > 0 ? "it unpacks to more than it says" : "it is cut";
      break;
    }
  }
  plain.resize(size);
  return plain;
}

}  // namespace strata::log
