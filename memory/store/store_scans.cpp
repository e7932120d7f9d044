// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <cstring>

#include "core/base/damage.hpp"
#include "memory/store/detail/blob.hpp"
#include "memory/store/detail/scan_header.hpp"
#include "memory/store/detail/store_impl.hpp"

namespace strata::memory {
namespace {

/// Scans that share one compressed blob: many, to compress well; few, to read in pieces.
constexpr std::size_t kScansPerChunk = 256;

/// Planes of the headers, which have the number of labels besides, then of all ranges, then of all
/// labels.
std::vector<std::byte> encode(std::span<const PosedScan> scans) {
  std::vector<detail::ScanHeader> headers;
  std::vector<float> ranges;
  std::vector<float> labels;
  for (const PosedScan& scan : scans) {
    headers.push_back(
        detail::header_of(scan, static_cast<std::uint32_t>(scan.static_probability.size())));
    ranges.insert(ranges.end(), scan.scan.ranges_m.begin(), scan.scan.ranges_m.end());
    labels.insert(labels.end(), scan.static_probability.begin(), scan.static_probability.end());
  }
  std::vector<std::byte> bytes = detail::to_planes(std::span<const detail::ScanHeader>(headers));
  for (const std::vector<float>* values : {&ranges, &labels}) {
    const std::vector<std::byte> planes = detail::to_planes(std::span<const float>(*values));
    bytes.insert(bytes.end(), planes.begin(), planes.end());
  }
  return bytes;
}

/// The chunk's scans, appended. Throws InputError when the sizes do not add up.
void decode(std::span<const std::byte> bytes, std::size_t count, int run, const std::string& place,
            std::vector<PosedScan>& scans) {
  std::vector<detail::ScanHeader> headers(count);
  std::size_t ranges = 0;
  std::size_t labels = 0;
  const std::size_t header_bytes = count * sizeof(detail::ScanHeader);
  if (bytes.size() >= header_bytes) {
    detail::from_planes(bytes.first(header_bytes), std::span<detail::ScanHeader>(headers));
    for (const detail::ScanHeader& header : headers) {
      ranges += header.ranges;
      labels += header.more;
    }
  }
  if (bytes.size() != header_bytes + (ranges + labels) * sizeof(float)) {
    throw DamageError(place, "its scans are damaged", "take the store from a backup");
  }
  std::vector<float> values(ranges + labels);
  const std::span<const std::byte> rest = bytes.subspan(header_bytes);
  detail::from_planes(rest.first(ranges * sizeof(float)), std::span(values).first(ranges));
  detail::from_planes(rest.subspan(ranges * sizeof(float)), std::span(values).subspan(ranges));
  const float* next_range = values.data();
  const float* next_label = values.data() + ranges;
  for (const detail::ScanHeader& header : headers) {
    PosedScan& posed = scans.emplace_back(detail::scan_of(header, run));
    posed.static_probability.resize(header.more);
    std::copy_n(next_range, header.ranges, posed.scan.ranges_m.begin());
    std::copy_n(next_label, header.more, posed.static_probability.begin());
    next_range += header.ranges;
    next_label += header.more;
  }
}

bool has_scan_table(detail::Database& database) {
  return database.query_integer("SELECT count(*) FROM sqlite_master WHERE name = 'scan_chunk'") !=
         0;
}

}  // namespace

void Store::save_scans(int run, std::span<const PosedScan> scans) {
  transaction([&] {
    detail::Database& database = impl_->database;
    detail::Statement(database, "DELETE FROM scan_chunk WHERE run = ?").bind(run).run();
    append_scans(run, scans);
  });
}

void Store::append_scans(int run, std::span<const PosedScan> scans) {
  transaction([&] {
    detail::Database& database = impl_->database;
    detail::Statement next(database,
                           "SELECT coalesce(max(place) + 1, 0) FROM scan_chunk WHERE run = ?");
    next.bind(run);
    std::int64_t place = next.step() ? next.integer(0) : 0;
    detail::Statement insert(database,
                             "INSERT INTO scan_chunk (run, place, scans, begin_ns, end_ns, data) "
                             "VALUES (?, ?, ?, ?, ?, ?)");
    for (std::size_t begin = 0; begin < scans.size(); begin += kScansPerChunk) {
      const auto chunk = scans.subspan(begin, std::min(kScansPerChunk, scans.size() - begin));
      insert.bind(run).bind(place++);
      insert.bind(static_cast<std::int64_t>(chunk.size()));
      insert.bind(chunk.front().scan.stamp.ns).bind(chunk.back().scan.stamp.ns);
      insert.bind(detail::compress(encode(chunk))).run();
    }
  });
}

std::vector<PosedScan> Store::load_scans(int run) const {
  std::vector<PosedScan> scans;
  if (!has_scan_table(impl_->database)) return scans;
  detail::Statement statement(
      impl_->database, "SELECT place, scans, data FROM scan_chunk WHERE run = ? ORDER BY place");
  statement.bind(run);
  while (statement.step()) {
    const std::string place = path_.string() + ": scans of run " + std::to_string(run) +
                              ", chunk " + std::to_string(statement.integer(0));
    const std::int64_t count = statement.integer(1);
    if (count < 0 || count > static_cast<std::int64_t>(kScansPerChunk)) {
      throw DamageError(place, "its scans are damaged", "take the store from a backup");
    }
    decode(detail::decompress(statement.blob(2), place), static_cast<std::size_t>(count), run,
           place, scans);
  }
  return scans;
}

std::vector<int> Store::runs_with_scans() const {
  std::vector<int> runs;
  if (!has_scan_table(impl_->database)) return runs;
  detail::Statement statement(impl_->database, "SELECT DISTINCT run FROM scan_chunk ORDER BY run");
  while (statement.step()) runs.push_back(static_cast<int>(statement.integer(0)));
  return runs;
}

}  // namespace strata::memory
