// SPDX-License-Identifier: Apache-2.0
#include "memory/store/detail/blob.hpp"

#include <array>
#include <new>
#include <utility>

#include <zstd.h>
#include <zstd_errors.h>

#include "core/base/damage.hpp"

namespace strata::memory::detail {
namespace {

/// Larger contents are not ours: a damaged length must not ask for all memory.
constexpr unsigned long long kMaxBytes = 1ULL << 36U;

[[noreturn]] void throw_damaged(const std::string& place) {
  throw DamageError(place, "its content is damaged",
                    "take the store from a backup, or learn the maps again into a new folder");
}

struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
};
using Context = std::unique_ptr<ZSTD_CCtx, FreeContext>;

Context make_context() {
  Context context(ZSTD_createCCtx());
  if (context == nullptr) throw std::bad_alloc();
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  return context;
}

}  // namespace

struct Compressor::Stream {
  Context context = make_context();
  std::vector<std::byte> frame;

  void pass(std::span<const std::byte> piece, ZSTD_EndDirective directive) {
    std::array<std::byte, 1U << 16U> packed;
    ZSTD_inBuffer in{piece.data(), piece.size(), 0};
    std::size_t left = 0;  // within the context
    do {
      ZSTD_outBuffer out{packed.data(), packed.size(), 0};
      left = ZSTD_compressStream2(context.get(), &out, &in, directive);
      if (ZSTD_isError(left) != 0U) throw std::bad_alloc();  // nothing else can fail
      frame.insert(frame.end(), packed.data(), packed.data() + out.pos);
    } while (directive == ZSTD_e_end ? left > 0 : in.pos < in.size);
  }
};

Compressor::Compressor(std::size_t content_bytes) : stream_(std::make_unique<Stream>()) {
  ZSTD_CCtx_setPledgedSrcSize(stream_->context.get(), content_bytes);
}

Compressor::~Compressor() = default;

void Compressor::add(std::span<const std::byte> piece) { stream_->pass(piece, ZSTD_e_continue); }

std::vector<std::byte> Compressor::finish() {
  stream_->pass({}, ZSTD_e_end);
  return std::move(stream_->frame);
}

std::vector<std::byte> compress(std::span<const std::byte> bytes) {
  return compress(bytes, ZSTD_CLEVEL_DEFAULT);
}

std::vector<std::byte> compress(std::span<const std::byte> bytes, int level) {
  const Context context = make_context();
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, level);
  // Not set to zero: memory that is never written to is never taken.
  const std::size_t most = ZSTD_compressBound(bytes.size());
  const auto blob = std::make_unique_for_overwrite<std::byte[]>(most);
  const std::size_t size =
      ZSTD_compress2(context.get(), blob.get(), most, bytes.data(), bytes.size());
  if (ZSTD_isError(size) != 0U) throw std::bad_alloc();  // nothing else can fail
  return {blob.get(), blob.get() + size};
}

std::vector<std::byte> decompress(std::span<const std::byte> blob, const std::string& place) {
  const unsigned long long stated = ZSTD_getFrameContentSize(blob.data(), blob.size());
  if (stated == ZSTD_CONTENTSIZE_ERROR || stated == ZSTD_CONTENTSIZE_UNKNOWN ||
      stated > kMaxBytes) {
    throw_damaged(place);
  }
  std::vector<std::byte> bytes(static_cast<std::size_t>(stated));
  const std::size_t size = ZSTD_decompress(bytes.data(), bytes.size(), blob.data(), blob.size());
  if (ZSTD_getErrorCode(size) == ZSTD_error_memory_allocation) throw std::bad_alloc();
  if (ZSTD_isError(size) != 0U || size != bytes.size()) throw_damaged(place);
  return bytes;
}

std::vector<std::byte> decompress(std::span<const std::byte> blob, std::size_t expected_size,
                                  const std::string& place) {
  if (ZSTD_getFrameContentSize(blob.data(), blob.size()) != expected_size) throw_damaged(place);
  return decompress(blob, place);
}

}  // namespace strata::memory::detail
