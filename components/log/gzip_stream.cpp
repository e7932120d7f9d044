// SPDX-License-Identifier: Apache-2.0
#include "components/log/gzip_stream.hpp"

#include <new>

#include <zlib.h>

namespace strata::log {

struct GzipBuffer::Deflater {
  Deflater() {
    constexpr int kGzip = 16;  // added to the window's bits: with gzip's header
    if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzip + MAX_WBITS, 8,
                     Z_DEFAULT_STRATEGY) != Z_OK) {
      throw std::bad_alloc();
    }
  }
  ~Deflater() { deflateEnd(&stream); }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;
  z_stream stream{};
};

GzipBuffer::GzipBuffer(std::ostream& packed)
    : packed_(packed), deflater_(std::make_unique<Deflater>()) {
  setp(plain_.data(), plain_.data() + plain_.size());
}

GzipBuffer::~GzipBuffer() = default;

void GzipBuffer::pack(bool is_end) {
  z_stream& stream = deflater_->stream;
  stream.next_in = reinterpret_cast<Bytef*>(pbase());
  stream.avail_in = static_cast<uInt>(pptr() - pbase());
  std::array<char, 1U << 14U> out;
  int state = Z_OK;
  do {
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    state = deflate(&stream, is_end ? Z_FINISH : Z_NO_FLUSH);
    packed_.write(out.data(), static_cast<std::streamsize>(out.size() - stream.avail_out));
  } while (state == Z_OK && (stream.avail_out == 0 || stream.avail_in > 0));
  setp(plain_.data(), plain_.data() + plain_.size());
}

GzipBuffer::int_type GzipBuffer::overflow(int_type character) {
  pack(false);
  if (traits_type::eq_int_type(character, traits_type::eof())) return traits_type::not_eof(0);
  return sputc(traits_type::to_char_type(character));
}

void GzipBuffer::finish() { pack(true); }

}  // namespace strata::log
