// SPDX-License-Identifier: Apache-2.0
/// MCAP as rosbag2 reads it: profile ros2, CDR messages in chunks with CRCs, message indexes, the
/// bag's metadata, and a summary that repeats schemas and channels.
#include <algorithm>
#include <chrono>
#include <fstream>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include <zlib.h>

#include "components/log/bag_storage.hpp"
#include "components/log/compression.hpp"
#include "components/log/mcap_records.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

constexpr std::size_t kChunkBytes = 1 << 20;
constexpr std::string_view kMetadataName = "rosbag2";

/// Little-endian fields.
class Record {
 public:
  template <typename T>
  Record& number(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
    return *this;
  }
  Record& raw(View data) {
    bytes_.insert(bytes_.end(), data.begin(), data.end());
    return *this;
  }
  Record& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    for (const char c : value) bytes_.push_back(static_cast<std::uint8_t>(c));
    return *this;
  }
  /// As a record: opcode, length, content.
  Record& record(std::uint8_t opcode, const Record& content) {
    number(opcode);
    number(static_cast<std::uint64_t>(content.bytes_.size()));
    return raw(content.bytes_);
  }
  void clear() { bytes_.clear(); }
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

class McapFile : public BagWriter::File {
 public:
  McapFile(const fs::path& file, BagCompression compression)
      : file_(file), out_(file, std::ios::binary | std::ios::trunc), compression_(compression) {
    Record start;
    start.raw(View(reinterpret_cast<const std::uint8_t*>(kMcapMagic.data()), kMcapMagic.size()));
    start.record(kHeader, Record().text("ros2").text("strata"));
    put(start);
  }

  void add_topic(const BagTopic& topic) override {
    const auto [schema, is_new] =
        schemas_.try_emplace(topic.type, static_cast<std::uint16_t>(schemas_.size() + 1));
    if (is_new) {
      const TypeDefinition definition = definition_of(topic);
      Record content;
      content.number(schema->second).text(topic.type);
      content.text(definition.encoding).text(definition.text);
      definitions_.record(kSchema, content);
      schema_records_.record(kSchema, content);
    }
    Record metadata;
    metadata.text("offered_qos_profiles").text(topic.offered_qos_profiles);
    if (const std::string hash = type_hash_of(topic); !hash.empty()) {
      metadata.text("topic_type_hash").text(hash);
    }
    Record channel;
    channel.number(channels_).number(schema->second).text(topic.name);
    channel.text(topic.serialization_format);
    channel.number(static_cast<std::uint32_t>(metadata.bytes().size())).raw(metadata.bytes());
    definitions_.record(kChannel, channel);
    channel_records_.record(kChannel, channel);
    counts_.push_back(0);
    ++channels_;
    // Every chunk begins with all topics, so that each can be read alone.
    end_chunk();
  }

  void write(std::size_t topic, Stamp stamp, View cdr) override {
    const auto ns = static_cast<std::uint64_t>(stamp.ns);
    if (messages_in_chunk_ == 0) {
      chunk_.clear();
      chunk_.raw(definitions_.bytes());
      chunk_defined_bytes_ = definitions_.bytes().size();
      chunk_begin_ = std::numeric_limits<std::uint64_t>::max();
      chunk_end_ = 0;
      chunk_started_ = Clock::now();
    }
    index_[static_cast<std::uint16_t>(topic)].emplace_back(ns, chunk_.bytes().size());
    const auto channel = static_cast<std::uint16_t>(topic);
    const std::uint64_t number = counts_.at(topic) + index_[channel].size() - 1;
    chunk_.number(kMessage).number(static_cast<std::uint64_t>(22 + cdr.size()));
    chunk_.number(channel).number(static_cast<std::uint32_t>(number));
    chunk_.number(ns).number(ns).raw(cdr);
    ++messages_in_chunk_;
    chunk_begin_ = std::min(chunk_begin_, ns);
    chunk_end_ = std::max(chunk_end_, ns);
    if (chunk_.bytes().size() > kChunkBytes ||
        Clock::now() - chunk_started_ > std::chrono::seconds(1)) {
      end_chunk();
    }
  }

  void close(const std::string& metadata) override {
    end_chunk();
    Record end;
    // Topics without a message, which no chunk has named yet.
    if (defined_bytes_ < definitions_.bytes().size()) end.raw(definitions_.bytes());
    const std::uint64_t metadata_at = position_ + end.bytes().size();
    end.record(kMetadata, rosbag2_metadata(metadata));
    const std::uint64_t metadata_bytes = position_ + end.bytes().size() - metadata_at;
    end.record(kDataEnd, Record().number(std::uint32_t{0}));
    const std::uint64_t summary = position_ + end.bytes().size();
    Record tail;
    tail.raw(schema_records_.bytes());
    const std::uint64_t channels_at = summary + tail.bytes().size();
    tail.raw(channel_records_.bytes());
    const std::uint64_t statistics_at = summary + tail.bytes().size();
    tail.record(kStatistics, statistics());
    const std::uint64_t chunks_at = summary + tail.bytes().size();
    tail.raw(chunk_indexes_.bytes());
    const std::uint64_t metadata_index_at = summary + tail.bytes().size();
    tail.record(kMetadataIndex,
                Record().number(metadata_at).number(metadata_bytes).text(kMetadataName));
    const std::uint64_t offsets_at = summary + tail.bytes().size();
    const auto group = [&](std::uint8_t opcode, std::uint64_t from, std::uint64_t to) {
      if (to > from) {
        tail.record(kSummaryOffset, Record().number(opcode).number(from).number(to - from));
      }
    };
    group(kSchema, summary, channels_at);
    group(kChannel, channels_at, statistics_at);
    group(kStatistics, statistics_at, chunks_at);
    group(kChunkIndex, chunks_at, metadata_index_at);
    group(kMetadataIndex, metadata_index_at, offsets_at);
    // The CRC covers the summary up to itself.
    tail.number(kFooter).number(std::uint64_t{20}).number(summary).number(offsets_at);
    const auto crc = static_cast<std::uint32_t>(
        crc32(0, tail.bytes().data(), static_cast<unsigned>(tail.bytes().size())));
    tail.number(crc);
    tail.raw(View(reinterpret_cast<const std::uint8_t*>(kMcapMagic.data()), kMcapMagic.size()));
    put(end.raw(tail.bytes()));
    out_.close();
    if (!out_) fail();
  }

  void flush() override { end_chunk(); }
  [[nodiscard]] std::size_t saved() const override { return saved_; }
  void give_up() override { drop_chunk(); }

 private:
  using Clock = std::chrono::steady_clock;

  [[noreturn]] void fail() const {
    throw OutputError(file_.string(), "cannot be written",
                      "free some space or choose another place");
  }
  /// All of it or nothing.
  void put(const Record& record) {
    out_.write(reinterpret_cast<const char*>(record.bytes().data()),
               static_cast<std::streamsize>(record.bytes().size()));
    if (out_.flush()) {
      position_ += record.bytes().size();
      return;
    }
    out_.close();
    std::error_code ignored;
    fs::resize_file(file_, position_, ignored);
    out_.clear();
    out_.open(file_, std::ios::binary | std::ios::app);
    fail();
  }

  void end_chunk() {
    if (messages_in_chunk_ == 0) return;
    const auto& plain = chunk_.bytes();
    const Bytes packed = compress(plain, compression_);
    const std::string_view name = compression_name(compression_);
    Record body;
    body.number(chunk_begin_).number(chunk_end_).number(std::uint64_t{plain.size()});
    body.number(
        static_cast<std::uint32_t>(crc32(0, plain.data(), static_cast<unsigned>(plain.size()))));
    body.text(name).number(std::uint64_t{packed.size()}).raw(packed);
    Record chunk;
    chunk.record(kChunk, body);

    Record entry;
    entry.number(chunk_begin_).number(chunk_end_).number(position_);
    entry.number(std::uint64_t{chunk.bytes().size()});
    Record offsets;
    Record indexes;
    const std::uint64_t indexes_at = position_ + chunk.bytes().size();
    for (const auto& [channel, entries] : index_) {
      offsets.number(channel).number(indexes_at + indexes.bytes().size());
      Record array;
      for (const auto& [ns, offset] : entries) {
        array.number(ns).number(static_cast<std::uint64_t>(offset));
      }
      Record index;
      index.number(channel).number(static_cast<std::uint32_t>(array.bytes().size()));
      index.raw(array.bytes());
      indexes.record(kMessageIndex, index);
    }
    entry.number(static_cast<std::uint32_t>(offsets.bytes().size())).raw(offsets.bytes());
    entry.number(std::uint64_t{indexes.bytes().size()}).text(name);
    entry.number(std::uint64_t{packed.size()}).number(std::uint64_t{plain.size()});
    put(chunk.raw(indexes.bytes()));
    begin_ = chunks_ == 0 ? chunk_begin_ : std::min(begin_, chunk_begin_);
    end_ = std::max(end_, chunk_end_);
    ++chunks_;
    saved_ += messages_in_chunk_;
    for (const auto& [channel, entries] : index_) counts_[channel] += entries.size();
    defined_bytes_ = chunk_defined_bytes_;
    chunk_indexes_.record(kChunkIndex, entry);
    drop_chunk();
  }

  void drop_chunk() {
    index_.clear();
    messages_in_chunk_ = 0;
  }

  /// As rosbag2 keeps what it would else have to read from metadata.yaml.
  [[nodiscard]] static Record rosbag2_metadata(const std::string& metadata) {
    Record values;
    values.text("serialized_metadata").text(metadata);
    Record record;
    record.text(kMetadataName).number(static_cast<std::uint32_t>(values.bytes().size()));
    return record.raw(values.bytes());
  }

  [[nodiscard]] Record statistics() const {
    std::uint64_t total = 0;
    Record counts;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      total += counts_[i];
      counts.number(static_cast<std::uint16_t>(i)).number(counts_[i]);
    }
    Record record;
    record.number(total).number(static_cast<std::uint16_t>(schemas_.size()));
    constexpr std::uint32_t kAttachments = 0;
    constexpr std::uint32_t kMetadataRecords = 1;
    record.number(static_cast<std::uint32_t>(channels_)).number(kAttachments);
    record.number(kMetadataRecords).number(chunks_).number(begin_).number(end_);
    record.number(static_cast<std::uint32_t>(counts.bytes().size())).raw(counts.bytes());
    return record;
  }

  fs::path file_;
  std::ofstream out_;
  BagCompression compression_;
  std::uint64_t position_ = 0;
  std::map<std::string, std::uint16_t> schemas_;
  std::uint16_t channels_ = 0;
  std::vector<std::uint64_t> counts_;  ///< by channel, of what is saved
  std::size_t saved_ = 0;
  Record definitions_;     ///< schemas and channels as they came, for the data section
  Record schema_records_;  ///< the same apart, for the summary, which groups its records
  Record channel_records_;
  std::size_t defined_bytes_ = 0;  ///< of definitions_ as the last saved chunk has them
  std::size_t chunk_defined_bytes_ = 0;
  Record chunk_;
  std::size_t messages_in_chunk_ = 0;
  std::uint64_t chunk_begin_ = 0;
  std::uint64_t chunk_end_ = 0;
  Clock::time_point chunk_started_;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::size_t>>> index_;
  Record chunk_indexes_;
  std::uint32_t chunks_ = 0;
  std::uint64_t begin_ = 0;
  std::uint64_t end_ = 0;
};

}  // namespace

std::unique_ptr<BagWriter::File> create_mcap(const fs::path& file, BagCompression compression) {
  return std::make_unique<McapFile>(file, compression);
}

}  // namespace strata::log
