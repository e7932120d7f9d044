// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <cstring>

#include "core/base/damage.hpp"
#include "memory/store/detail/blob.hpp"
#include "memory/store/detail/store_impl.hpp"

namespace strata::memory {
namespace {

/// Scans that share one compressed blob: many, to compress well; few, to read in pieces.
constexpr std::size_t kScansPerChunk = 256;

/// Everything of a scan but its beams. No padding: it goes to disk as it lies in memory.
struct ScanHeader {
  std::int64_t stamp_ns;
  double map_from_robot[3];
  double robot_from_laser[3];
  float angle_min_rad;
  float angle_increment_rad;
  float time_increment_s;
  float scan_time_s;
  float range_min_m;
  float range_max_m;
  std::uint32_t ranges;
  std::uint32_t labels;
};
static_assert(sizeof(ScanHeader) == 88);

ScanHeader header_of(const PosedScan& posed) {
  const Scan& scan = posed.scan;
  const Pose2& pose = posed.map_from_robot;
  const Pose2& laser = scan.robot_from_laser;
  return {scan.stamp.ns,
          {pose.x, pose.y, pose.theta},
          {laser.x, laser.y, laser.theta},
          scan.angle_min_rad,
          scan.angle_increment_rad,
          scan.time_increment_s,
          scan.scan_time_s,
          scan.range_min_m,
          scan.range_max_m,
          static_cast<std::uint32_t>(scan.ranges_m.size()),
          static_cast<std::uint32_t>(posed.static_probability.size())};
}

PosedScan scan_of(const ScanHeader& header, int run) {
  PosedScan posed;
  posed.run = run;
  posed.map_from_robot = {header.map_from_robot[0], header.map_from_robot[1],
                          header.map_from_robot[2]};
  Scan& scan = posed.scan;
  scan.stamp = {header.stamp_ns};
  scan.robot_from_laser = {header.robot_from_laser[0], header.robot_from_laser[1],
                           header.robot_from_laser[2]};
  scan.angle_min_rad = header.angle_min_rad;
  scan.angle_increment_rad = header.angle_increment_rad;
  scan.time_increment_s = header.time_increment_s;
  scan.scan_time_s = header.scan_time_s;
  scan.range_min_m = header.range_min_m;
  scan.range_max_m = header.range_max_m;
  scan.ranges_m.resize(header.ranges);
  posed.static_probability.resize(header.labels);
  return posed;
}

/// Planes of the headers, then of all ranges, then of all labels.
std::vector<std::byte> encode(std::span<const PosedScan> scans) {
  std::vector<ScanHeader> headers;
  std::vector<float> ranges;
  std::vector<float> labels;
  for (const PosedScan& scan : scans) {
    headers.push_back(header_of(scan));
    ranges.insert(ranges.end(), scan.scan.ranges_m.begin(), scan.scan.ranges_m.end());
    labels.insert(labels.end(), scan.static_probability.begin(), scan.static_probability.end());
  }
  std::vector<std::byte> bytes = detail::to_planes(std::span<const ScanHeader>(headers));
  for (const std::vector<float>* values : {&ranges, &labels}) {
    const std::vector<std::byte> planes = detail::to_planes(std::span<const float>(*values));
    bytes.insert(bytes.end(), planes.begin(), planes.end());
  }
  return bytes;
}

/// The chunk's scans, appended. Throws InputError when the sizes do not add up.
void decode(std::span<const std::byte> bytes, std::size_t count, int run, const std::string& place,
            std::vector<PosedScan>& scans) {
  std::vector<ScanHeader> headers(count);
  std::size_t ranges = 0;
  std::size_t labels = 0;
  const std::size_t header_bytes = count * sizeof(ScanHeader);
  if (bytes.size() >= header_bytes) {
    detail::from_planes(bytes.first(header_bytes), std::span<ScanHeader>(headers));
    for (const ScanHeader& header : headers) {
      ranges += header.ranges;
      labels += header.labels;
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
  for (const ScanHeader& header : headers) {
    PosedScan& posed = scans.emplace_back(scan_of(header, run));
    std::copy_n(next_range, header.ranges, posed.scan.ranges_m.begin());
    std::copy_n(next_label, header.labels, posed.static_probability.begin());
    next_range += header.ranges;
    next_label += header.labels;
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
