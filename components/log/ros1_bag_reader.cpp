// SPDX-License-Identifier: Apache-2.0
/// ROS 1 bags of format 2.0. The chunks are read one after the other; the index only says where
/// they lie and when they begin, and is missing when a recording broke off.
#include <algorithm>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "components/log/bag_storage.hpp"
#include "components/log/bz2.hpp"
#include "components/log/compression.hpp"
#include "components/log/piecewise_bag_reader.hpp"
#include "components/log/ros1_records.hpp"
#include "components/log/ros1_topics.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

/// As kLargestChunk.
constexpr std::uint64_t kLargestHeader = 1ULL << 20;

constexpr std::uint64_t kUnknownBegin = std::numeric_limits<std::uint64_t>::max();

class Ros1BagReader final : public PiecewiseBagReader {
 public:
  using PiecewiseBagReader::PiecewiseBagReader;

  const std::vector<BagTopic>& topics() const override { return topics_.topics(); }
  std::string description() const override {
    std::string text = "ROSBAG V2.0";
    for (const std::string& method : methods_) {
      text += method == "none" ? "" : ", chunks packed with " + method;
    }
    return text + (has_whole_index_ ? "" : ", without a whole index");
  }

 private:
  struct Record {
    Ros1Fields fields;
    Ros1Op op = Ros1Op::kBagHeader;
    std::uint64_t data_at = 0;
    std::uint64_t data_size = 0;
    bool is_cut = false;  ///< the file ends before the data does
  };

  static std::string method_of(const Record& record) {
    const std::string method = record.fields.text("compression");
    return method.empty() ? "none" : method;
  }

  void find_pieces() override {
    require_ros1_format(read(0, 20), name());
    scan_file();
    inspect();
  }

  /// Why there is no record; empty when there is one, whose data may be cut.
  std::string read_record(std::uint64_t at, Record& record) {
    const auto length_at = [&](std::uint64_t offset) {
      return ByteCursor(read(offset, 4)).number<std::uint32_t>();
    };
    const std::string cut = "the file is cut here";
    if (file_size() - at < 4) return cut;
    const std::uint64_t header_size = length_at(at);
    if (header_size > kLargestHeader) return "is not a record";
    if (file_size() - at < 8 + header_size) return cut;
    record.fields = Ros1Fields(read(at + 4, header_size));
    const auto op = record.fields.op();
    if (!record.fields.ok() || !op) return "is not a record";
    record.op = *op;
    record.data_at = at + 8 + header_size;
    record.data_size = length_at(record.data_at - 4);
    record.is_cut = record.data_size > file_size() - record.data_at;
    return "";
  }

  void scan_file() {
    std::uint64_t at = kRos1Magic.size();
    Record header;
    const std::string why = read_record(at, header);
    if (why.empty() && header.op == Ros1Op::kBagHeader && !header.is_cut) {
      refuse_encrypted(header.fields);
      index_at_ = header.fields.number<std::uint64_t>("index_pos").value_or(0);
      index_records_ = header.fields.number<std::uint32_t>("conn_count").value_or(0);
      index_records_ += header.fields.number<std::uint32_t>("chunk_count").value_or(0);
      at = header.data_at + header.data_size;
    } else {
      note_damage(at, "the bag's header is damaged");
      at += kRos1BagHeaderBytes;
    }
    if (index_at_ >= at && index_at_ <= file_size()) read_index();
    const std::uint64_t end = has_index() ? index_at_ : file_size();
    while (at < end) at = scan_record(at, end);
    if (!has_whole_index_ && damage().count == 0) {
      note_damage(file_size(), "the bag ends without its index, as when recording broke off");
    }
  }

  void refuse_encrypted(const Ros1Fields& header) const {
    const std::string encryptor = header.text("encryptor");
    if (encryptor.empty() || encryptor == "rosbag/NoEncryptor") return;
    throw InputError(name(), "is encrypted (" + encryptor + ")",
                     "have ROS 1 decrypt it: `rosbag decrypt`");
  }

  [[nodiscard]] bool has_index() const { return has_whole_index_ || !chunks_at_.empty(); }

  /// At the end of the bag: all connections again, and where the chunks lie.
  void read_index() {
    std::uint64_t at = index_at_;
    std::uint64_t records = 0;
    for (; at < file_size(); ++records) {
      Record record;
      if (!read_record(at, record).empty() || record.is_cut) return;
      if (record.op == Ros1Op::kConnection) {
        take_connection(record.fields, read(record.data_at, record.data_size), at);
      } else if (record.op == Ros1Op::kChunkInfo) {
        if (const auto chunk = record.fields.number<std::uint64_t>("chunk_pos")) {
          chunks_at_.insert(*chunk);
        }
      } else {
        return;
      }
      at = record.data_at + record.data_size;
    }
    has_whole_index_ = records >= index_records_;
  }

  /// Where to go on: behind the record, or, where there is none, at the next chunk that the index
  /// knows.
  std::uint64_t scan_record(std::uint64_t at, std::uint64_t end) {
    Record record;
    const std::string why = read_record(at, record);
    if (!why.empty()) {
      const std::uint64_t next = next_chunk(at, end);
      note_damage(at, why + "; " +
                          (next < end ? "what lies before the next chunk is left out"
                                      : "nothing behind it is read"));
      return next;
    }
    if (record.op == Ros1Op::kIndex) correct_size(record, end);
    const std::uint64_t stated = record.is_cut ? file_size() : record.data_at + record.data_size;
    const std::uint64_t behind = std::max(next_chunk(at, std::min(stated, end)), record.data_at);
    if (record.is_cut && behind == file_size()) {
      note_damage(at, "the file is cut in this record");
    } else if (stated > behind) {
      note_damage(at, "this record states more bytes than it has");
      record.is_cut = true;
    }
    if (record.op == Ros1Op::kChunk) return add_chunk(at, record, behind);
    if (record.is_cut) return behind;
    if (record.op == Ros1Op::kMessage) {
      const Stamp stamp = record.fields.time("time").value_or(Stamp{});
      pieces().push_back({static_cast<std::uint64_t>(stamp.ns), at, record.data_size,
                          static_cast<std::uint8_t>(record.op)});
    } else if (record.op == Ros1Op::kConnection) {
      take_connection(record.fields, read(record.data_at, record.data_size), at);
    } else if (record.op == Ros1Op::kIndex && !pieces().empty()) {
      BagPiece& chunk = pieces().back();
      const Bytes index = read(record.data_at, record.data_size);
      chunk.begin_ns = std::min(chunk.begin_ns, ros1_index_begin_ns(index));
    }
    return behind;
  }

  /// The first chunk behind a place that the index knows and that is one; end when there is none.
  std::uint64_t next_chunk(std::uint64_t at, std::uint64_t end) {
    for (auto next = chunks_at_.upper_bound(at); next != chunks_at_.end() && *next < end; ++next) {
      Record record;
      if (read_record(*next, record).empty() && record.op == Ros1Op::kChunk) return *next;
    }
    return end;
  }

  /// Bags of 2010 state 20 bytes for each entry of an index where they have 12. ROS goes by how
  /// many entries it counts, so this does where a record follows then.
  void correct_size(Record& record, std::uint64_t end) {
    const std::uint64_t size = 12ULL * record.fields.number<std::uint32_t>("count").value_or(0);
    if (size == 0 || size >= record.data_size) return;
    const std::uint64_t behind = record.data_at + size;
    Record next;
    if (behind != end && (behind > end || !read_record(behind, next).empty())) return;
    record.data_size = size;
    record.is_cut = false;
  }

  std::uint64_t add_chunk(std::uint64_t at, const Record& record, std::uint64_t behind) {
    BagPiece chunk{kUnknownBegin, at, behind - record.data_at,
                   static_cast<std::uint8_t>(Ros1Op::kChunk)};
    const std::string method = method_of(record);
    methods_.insert(method);
    // Recording writes the lengths when a chunk is finished; the records of one that is not packed
    // follow as if they lay outside.
    const bool is_unfinished = record.data_size == 0 && method != "none" && behind < file_size() &&
                               record.fields.number<std::uint32_t>("size").value_or(0) == 0;
    if (is_unfinished) {
      note_damage(at, "this chunk was not finished, as when recording broke off");
      chunk.size = file_size() - record.data_at;
      behind = file_size();
    }
    pieces().push_back(chunk);
    return behind;
  }

  /// What the index would have told: connections, and when chunks begin.
  void inspect() {
    for (BagPiece& piece : pieces()) {
      if (piece.kind != static_cast<std::uint8_t>(Ros1Op::kChunk)) continue;
      if (has_whole_index_ && piece.begin_ns != kUnknownBegin) continue;
      std::string ignored;  // said when it is loaded
      for_each_ros1_record(content(piece, ignored), [&](const Ros1Fields& fields, View data) {
        if (fields.op() == Ros1Op::kConnection) take_connection(fields, data, piece.offset);
        if (fields.op() != Ros1Op::kMessage) return;
        const Stamp stamp = fields.time("time").value_or(Stamp{});
        piece.begin_ns = std::min(piece.begin_ns, static_cast<std::uint64_t>(stamp.ns));
      });
    }
  }

  /// Of a chunk; what came out before the error where there is one.
  Bytes content(const BagPiece& piece, std::string& error) {
    Record record;
    error = read_record(piece.offset, record);
    if (!error.empty()) return {};
    Bytes packed = read(record.data_at, piece.size);
    const std::string method = method_of(record);
    if (method == "none") return packed;
    const std::uint64_t size = record.fields.number<std::uint32_t>("size").value_or(0);
    const bool is_whole = record.data_size == piece.size;
    const std::uint64_t limit = is_whole ? std::min(size, kLargestChunk) : kLargestChunk;
    Bytes plain;
    if (method == "bz2") {
      plain = unpack_bz2(packed, limit, error);
    } else if (method == "lz4") {
      plain = decompress(packed, BagCompression::kLz4, limit, error);
    } else {
      error = "unknown compression " + method;
    }
    if (is_whole && error.empty() && plain.size() != size) error = "it unpacks to another length";
    // Only what is cut is whole up to its end.
    if (is_whole && !error.empty()) plain.clear();
    return plain;
  }

  void load(const BagPiece& piece) override {
    Record record;
    std::string error = read_record(piece.offset, record);
    if (record.op == Ros1Op::kMessage) {
      take_message(record.fields, read(record.data_at, piece.size), piece.offset);
      return;
    }
    const bool is_whole = record.data_size == piece.size;
    const Bytes records = content(piece, error);
    if (is_whole && !error.empty()) {
      note_damage(piece.offset, "a chunk is left out: " + error);
    }
    const bool is_even = for_each_ros1_record(records, [&](const Ros1Fields& fields, View data) {
      if (fields.op() == Ros1Op::kConnection) take_connection(fields, data, piece.offset);
      if (fields.op() == Ros1Op::kMessage) take_message(fields, data, piece.offset);
    });
    if (is_whole && !is_even) note_damage(piece.offset, "a chunk ends inside a record");
  }

  void take_connection(const Ros1Fields& fields, View data, std::uint64_t offset) {
    const std::string problem = topics_.add(fields, data);
    if (!problem.empty()) note_damage(offset, problem);
  }

  void take_message(const Ros1Fields& fields, View data, std::uint64_t offset) {
    try {
      add_message(topics_.message(fields, data, place(offset)));
    } catch (const InputError& error) {
      note_damage(error.what());
    }
  }

  std::uint64_t index_at_ = 0;
  std::uint64_t index_records_ = 0;  ///< so many belong to the index
  bool has_whole_index_ = false;
  std::set<std::uint64_t> chunks_at_;  ///< by the index
  std::set<std::string> methods_;
  Ros1Topics topics_;
};

}  // namespace

std::unique_ptr<BagReader> open_ros1_bag(const fs::path& file, const fs::path& shown) {
  return start_reader<Ros1BagReader>(file, shown);
}

}  // namespace strata::log
