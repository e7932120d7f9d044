// SPDX-License-Identifier: Apache-2.0
#include "components/log/compression.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <new>
#include <system_error>

#include <fcntl.h>
#include <lz4frame.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include "components/log/spooled_input.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

constexpr std::size_t kBlockBytes = 1 << 18;
/// How names of unpacked files begin.
constexpr const char* kUnpacked = "strata-unpacked-";

struct FreeZstd {
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
};
struct FreeLz4 {
  void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
};

/// Unpacks piece by piece.
class FrameDecoder {
 public:
  explicit FrameDecoder(BagCompression compression) {
    if (compression == BagCompression::kZstd) {
      zstd_.reset(ZSTD_createDCtx());
      if (!zstd_) throw std::bad_alloc();
    } else {
      LZ4F_dctx* context = nullptr;
      if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0U) {
        throw std::bad_alloc();  // nothing else can fail
      }
      lz4_.reset(context);
    }
  }
  /// Takes from the front of `in` and fills the front of `out`; returns how much was filled.
  std::size_t step(View& in, std::span<std::uint8_t> out) {
    std::size_t taken = in.size();
    std::size_t filled = out.size();
    std::size_t hint = 0;
    if (zstd_) {
      ZSTD_inBuffer from{in.data(), in.size(), 0};
      ZSTD_outBuffer to{out.data(), out.size(), 0};
      hint = ZSTD_decompressStream(zstd_.get(), &to, &from);
      if (ZSTD_isError(hint) != 0U) error_ = ZSTD_getErrorName(hint);
      taken = from.pos;
      filled = to.pos;
    } else {
      hint = LZ4F_decompress(lz4_.get(), out.data(), &filled, in.data(), &taken, nullptr);
      if (LZ4F_isError(hint) != 0U) {
        error_ = LZ4F_getErrorName(hint);
        filled = 0;
      }
    }
    in = in.subspan(std::min(taken, in.size()));
    finished_ = error_.empty() && hint == 0;
    return filled;
  }
  /// Whether a frame has come to its end.
  [[nodiscard]] bool finished() const { return finished_; }
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  std::unique_ptr<ZSTD_DCtx, FreeZstd> zstd_;
  std::unique_ptr<LZ4F_dctx, FreeLz4> lz4_;
  bool finished_ = false;
  std::string error_;
};

/// Unpacks all frames of `in` behind one another into `out`; returns why it ends early.
std::string unpack(std::istream& in, BagCompression compression, std::ostream& out) {
  if (compression == BagCompression::kNone) {
    out << in.rdbuf();
    return "";
  }
  FrameDecoder decoder(compression);
  Bytes packed(kBlockBytes);
  Bytes plain(kBlockBytes);
  while (in && out) {
    in.read(reinterpret_cast<char*>(packed.data()), static_cast<std::streamsize>(packed.size()));
    View rest(packed.data(), static_cast<std::size_t>(in.gcount()));
    bool more = !rest.empty();
    while (more && out) {
      const std::size_t filled = decoder.step(rest, plain);
      out.write(reinterpret_cast<const char*>(plain.data()), static_cast<std::streamsize>(filled));
      if (!decoder.error().empty()) return decoder.error();
      more = !rest.empty() || filled == plain.size();
    }
  }
  return decoder.finished() ? "" : "it is cut";
}

/// Of processes that were killed, which left them without a lock. Others' cannot be opened.
void remove_unpacked_of_killed() {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(fs::temp_directory_path(error), error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kUnpacked)) continue;
    const int file = open(entry.path().c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0) continue;
    if (flock(file, LOCK_EX | LOCK_NB) == 0) fs::remove(entry.path(), error);
    ::close(file);
  }
}

/// An empty file of its own, open and locked; its name goes into `path`. Negative where none can be
/// made.
int make_locked(fs::path& path) {
  for (;;) {
    std::string name = (fs::temp_directory_path() / kUnpacked).string() + "XXXXXX";
    const int file = mkostemp(name.data(), O_CLOEXEC);
    path = name;
    if (file < 0) return file;
    struct stat status {};
    (void)flock(file, LOCK_EX | LOCK_NB);
    if (fstat(file, &status) != 0 || status.st_nlink > 0) return file;
    ::close(file);  // taken for left over, before it had the lock
  }
}

}  // namespace

std::string_view compression_name(BagCompression compression) {
  constexpr std::string_view names[] = {"", "zstd", "lz4"};
  return names[static_cast<std::size_t>(compression)];
}

BagCompression compression_of(View bytes) {
  constexpr std::uint8_t zstd[] = {0x28, 0xB5, 0x2F, 0xFD};
  constexpr std::uint8_t lz4[] = {0x04, 0x22, 0x4D, 0x18};
  if (bytes.size() < 4) return BagCompression::kNone;
  if (std::equal(std::begin(zstd), std::end(zstd), bytes.begin())) return BagCompression::kZstd;
  if (std::equal(std::begin(lz4), std::end(lz4), bytes.begin())) return BagCompression::kLz4;
  return BagCompression::kNone;
}

BagCompression compression_of_file(const fs::path& file) {
  std::ifstream in(readable_path(file), std::ios::binary);
  Bytes head(4);
  in.read(reinterpret_cast<char*>(head.data()), 4);
  return in ? compression_of(head) : BagCompression::kNone;
}

// The room is enough by what the libraries say, so memory is all that can be missing.
Bytes compress(View plain, BagCompression compression) {
  Bytes packed;
  if (compression == BagCompression::kZstd) {
    const std::unique_ptr<ZSTD_CCtx, FreeZstd> context(ZSTD_createCCtx());
    if (!context) throw std::bad_alloc();
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);  // flipped bits are found
    packed.resize(ZSTD_compressBound(plain.size()));
    const std::size_t size =
        ZSTD_compress2(context.get(), packed.data(), packed.size(), plain.data(), plain.size());
    if (ZSTD_isError(size) != 0U) throw std::bad_alloc();
    packed.resize(size);
  } else if (compression == BagCompression::kLz4) {
    packed.resize(LZ4F_compressFrameBound(plain.size(), nullptr));
    const std::size_t size =
        LZ4F_compressFrame(packed.data(), packed.size(), plain.data(), plain.size(), nullptr);
    if (LZ4F_isError(size) != 0U) throw std::bad_alloc();
    packed.resize(size);
  } else {
    packed.assign(plain.begin(), plain.end());
  }
  return packed;
}

Bytes decompress(View packed, BagCompression compression, std::uint64_t limit, std::string& error) {
  error.clear();
  if (compression == BagCompression::kNone) return {packed.begin(), packed.end()};
  FrameDecoder decoder(compression);
  const auto most = static_cast<std::size_t>(limit);
  Bytes plain(std::min(most, 4 * packed.size() + 64));
  std::size_t size = 0;
  while (true) {
    const std::size_t before = packed.size();
    const std::size_t filled = decoder.step(packed, std::span(plain).subspan(size));
    size += filled;
    error = decoder.error();
    if (!error.empty() || decoder.finished()) break;
    if (size == plain.size() && size < most) {
      plain.resize(std::min(most, 2 * plain.size()));
    } else if (filled == 0 && packed.size() == before) {
      error = size == most && !packed.empty() ? "it unpacks to more than it says" : "it is cut";
      break;
    }
  }
  plain.resize(size);
  return plain;
}

UnpackedFile::UnpackedFile(const fs::path& file) {
  std::ifstream in(readable_path(file), std::ios::binary);
  if (!in) throw InputError(file.string(), "cannot be opened", "check its permissions");
  remove_unpacked_of_killed();
  lock_ = make_locked(path_);
  std::ofstream out(path_, std::ios::binary);
  if (lock_ >= 0 && out) {
    const std::string why = unpack(in, compression_of_file(file), out);
    if (!why.empty()) damage_ = file.string() + ": its compressed content ends early: " + why;
    out.close();
  }
  if (lock_ >= 0 && out) return;
  remove();
  throw InputError(file.string(), "cannot be unpacked into " + path_.parent_path().string(),
                   "free some space there, or set TMPDIR to another folder");
}

UnpackedFile::~UnpackedFile() { remove(); }

void UnpackedFile::remove() const {
  if (lock_ < 0) return;
  std::error_code ignored;
  fs::remove(path_, ignored);
  ::close(lock_);
}

void pack_file(const fs::path& file, const fs::path& packed) {
  std::ifstream in(file, std::ios::binary);
  std::ofstream out(packed, std::ios::binary | std::ios::trunc);
  const std::unique_ptr<ZSTD_CCtx, FreeZstd> context(ZSTD_createCCtx());
  if (!context) throw std::bad_alloc();
  Bytes plain(kBlockBytes);
  Bytes frame(ZSTD_CStreamOutSize());
  bool last = false;
  while (!last && out) {
    in.read(reinterpret_cast<char*>(plain.data()), static_cast<std::streamsize>(plain.size()));
    last = !in;
    ZSTD_inBuffer from{plain.data(), static_cast<std::size_t>(in.gcount()), 0};
    std::size_t left = 1;
    while (left > 0 && out) {
      ZSTD_outBuffer to{frame.data(), frame.size(), 0};
      left = ZSTD_compressStream2(context.get(), &to, &from, last ? ZSTD_e_end : ZSTD_e_continue);
      if (ZSTD_isError(left) != 0U) out.setstate(std::ios::failbit);
      out.write(reinterpret_cast<const char*>(frame.data()), static_cast<std::streamsize>(to.pos));
      if (!last && from.pos == from.size) break;
    }
  }
  out.close();
  if (!out || in.bad()) {
    throw OutputError(packed.string(), "cannot be written",
                      "free some space or choose another place");
  }
}

}  // namespace strata::log
