// SPDX-License-Identifier: Apache-2.0
/// MCAP as rosbag2 writes it: chunks plain, zstd or lz4, with CRCs. The data section alone is read;
/// summary and indexes only repeat it, and are missing when a recording broke off.
#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include <zlib.h>

#include "components/log/bag_storage.hpp"
#include "components/log/byte_cursor.hpp"
#include "components/log/compression.hpp"
#include "components/log/mcap_records.hpp"
#include "components/log/piecewise_bag_reader.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

/// Empty with a reason when the bytes are not what they should be.
Bytes unpack(const std::string& method, View packed, std::uint64_t size, std::string& error) {
  if (method.empty()) return {packed.begin(), packed.end()};
  const auto compression = method == "zstd"  ? BagCompression::kZstd
                           : method == "lz4" ? BagCompression::kLz4
                                             : BagCompression::kNone;
  if (compression == BagCompression::kNone) {
    error = "unknown compression " + method;
    return {};
  }
  Bytes plain = decompress(packed, compression, size, error);
  if (error.empty() && plain.size() != size) error = "it unpacks to another length";
  if (!error.empty()) plain.clear();
  return plain;
}

class McapReader final : public PiecewiseBagReader {
 public:
  using PiecewiseBagReader::PiecewiseBagReader;

  const std::vector<BagTopic>& topics() const override { return topics_; }
  std::string description() const override {
    return "MCAP" + (compression_.empty() ? std::string() : ", chunks packed with " + compression_);
  }

 private:
  struct Schema {
    std::string type;
    std::string encoding;
    std::string definition;
  };

  /// Walks over the records of the file without reading chunks.
  void find_pieces() override {
    std::uint64_t at = 8;  // behind the magic
    while (at < file_size()) {
      const Bytes head = read(at, 9);
      ByteCursor cursor{View(head)};
      const auto opcode = cursor.number<std::uint8_t>();
      const auto length = cursor.number<std::uint64_t>();
      if (!cursor.ok() || length > file_size() - at - 9) {
        note_damage(at, "the file is cut here");
        return;
      }
      const std::uint64_t body = at + 9;
      if (opcode == kDataEnd || opcode == kFooter) return;
      if (opcode == kChunk || opcode == kMessage) {
        const Bytes start = read(body, std::min<std::uint64_t>(length, 24));
        ByteCursor fields{View(start)};
        if (opcode == kMessage) fields.take(6);
        pieces().push_back({fields.number<std::uint64_t>(), body, length, opcode});
      } else if (opcode == kSchema || opcode == kChannel) {
        const Bytes record = read(body, length);
        take_record(opcode, record, body);
      } else if (opcode == 0 || (opcode > kDataEnd && opcode < 0x80)) {
        note_damage(at, "is not a record; nothing behind it is read");
        return;
      }
      at = body + length;
    }
    note_damage(at, "the file ends without its end mark");
  }

  void load(const BagPiece& piece) override {
    const Bytes bytes = read(piece.offset, piece.size);
    if (piece.kind == kMessage) {
      take_record(kMessage, bytes, piece.offset);
    } else {
      load_chunk(bytes, piece.offset);
    }
  }

  void load_chunk(View bytes, std::uint64_t offset) {
    ByteCursor cursor(bytes);
    cursor.number<std::uint64_t>();
    cursor.number<std::uint64_t>();
    const auto plain_size = cursor.number<std::uint64_t>();
    const auto crc = cursor.number<std::uint32_t>();
    const std::string method = cursor.text();
    const View packed = cursor.take(cursor.number<std::uint64_t>());
    if (cursor.ok()) compression_ = method;
    std::string error;
    Bytes plain;
    if (!cursor.ok() || plain_size > kLargestChunk) {
      error = "its header is damaged";
    } else {
      plain = unpack(method, packed, plain_size, error);
      if (error.empty() && crc != 0 &&
          crc32(0, plain.data(), static_cast<unsigned>(plain.size())) != crc) {
        error = "its checksum does not fit";
      }
    }
    if (!error.empty()) {
      note_damage(offset, "a chunk is left out: " + error);
      return;
    }
    ByteCursor records{View(plain)};
    while (records.left() > 0) {
      const auto opcode = records.number<std::uint8_t>();
      const View body = records.take(records.number<std::uint64_t>());
      if (!records.ok()) {
        note_damage(offset, "a chunk ends inside a record");
        return;
      }
      take_record(opcode, body, offset);
    }
  }

  void take_record(std::uint8_t opcode, View body, std::uint64_t offset) {
    ByteCursor cursor(body);
    if (opcode == kSchema) {
      const auto id = cursor.number<std::uint16_t>();
      Schema& schema = schemas_[id];
      schema.type = cursor.text();
      schema.encoding = cursor.text();
      schema.definition = cursor.text();
    } else if (opcode == kChannel) {
      take_channel(cursor);
    } else if (opcode == kMessage) {
      const auto channel = places_.find(cursor.number<std::uint16_t>());
      cursor.number<std::uint32_t>();
      const auto stamp = cursor.number<std::uint64_t>();
      cursor.number<std::uint64_t>();
      constexpr auto kLatest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
      if (!cursor.ok() || channel == places_.end() || stamp > kLatest) {
        note_damage(offset, "a message is not readable or belongs to no topic");
        return;
      }
      const View data = cursor.rest();
      add_message(
          {channel->second, {static_cast<std::int64_t>(stamp)}, {data.begin(), data.end()}});
      return;
    }
    if (!cursor.ok()) note_damage(offset, "a record is too short");
  }

  void take_channel(ByteCursor& cursor) {
    const auto id = cursor.number<std::uint16_t>();
    const auto schema = cursor.number<std::uint16_t>();
    BagTopic topic;
    topic.name = cursor.text();
    topic.serialization_format = cursor.text();
    const auto metadata = cursor.text_map();
    if (!cursor.ok() || places_.contains(id)) return;
    topic.type = schemas_[schema].type;
    topic.definition = schemas_[schema].definition;
    topic.definition_encoding = schemas_[schema].encoding;
    if (const auto qos = metadata.find("offered_qos_profiles"); qos != metadata.end()) {
      topic.offered_qos_profiles = qos->second;
    }
    if (const auto hash = metadata.find("topic_type_hash"); hash != metadata.end()) {
      topic.type_hash = hash->second;
    }
    places_[id] = topics_.size();
    topics_.push_back(std::move(topic));
  }

  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, std::size_t> places_;
  std::vector<BagTopic> topics_;
  std::string compression_;  ///< of the last chunk
};

}  // namespace

std::unique_ptr<BagReader> open_mcap(const fs::path& file, const fs::path& shown) {
  return start_reader<McapReader>(file, shown);
}

}  // namespace strata::log
