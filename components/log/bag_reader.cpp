// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <exception>
#include <optional>
#include <utility>

#include "components/log/bag.hpp"
#include "components/log/bag_storage.hpp"
#include "components/log/compression.hpp"
#include "components/log/spooled_input.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

/// No honest message is larger; a damaged one must not take the machine's memory.
constexpr std::uint64_t kLargestMessage = 512ULL << 20;

std::unique_ptr<BagReader> open_plain(const fs::path& file, const fs::path& shown) {
  if (is_mcap(file)) return open_mcap(file, shown);
  if (is_sqlite(file)) return open_sqlite_bag(file, shown);
  if (is_ros1_bag(file)) return open_ros1_bag(file, shown);
  throw InputError(shown.string(), "is neither an SQLite nor an MCAP bag, nor one of ROS 1",
                   "check that it was copied whole");
}

/// The files of a bag one after the other, as one; files and messages that rosbag2 compressed come
/// out unpacked.
class BagFiles : public BagReader {
 public:
  explicit BagFiles(const BagFolderFiles& found) : packed_messages_(found.packed_messages) {
    std::exception_ptr first_error;
    for (const fs::path& file : found.files) {
      try {
        open_file(file);
      } catch (const InputError& error) {
        if (!first_error) first_error = std::current_exception();
        damage_.add(error.what());
      }
    }
    if (parts_.empty()) std::rethrow_exception(first_error);
    for (Part& part : parts_) map_topics(part);
  }

  const std::vector<BagTopic>& topics() const override { return topics_; }
  const BagDamage& damage() const override { return damage_; }
  std::string description() const override {
    std::string text = parts_.size() > 1 ? std::to_string(parts_.size()) + " files, " : "";
    text += parts_.front().reader->description();
    if (packed_file_ != BagCompression::kNone) {
      text += ", files packed with " + std::string(compression_name(packed_file_));
    }
    if (packed_messages_) text += ", messages packed one by one";
    return text;
  }

  bool next(BagMessage& message) override {
    while (current_ < parts_.size()) {
      Part& part = parts_[current_];
      while (part.reader->next(message)) {
        map_topics(part);
        message.topic = part.topics[message.topic];
        if (unpack(part, message)) return true;
      }
      const BagDamage& damage = part.reader->damage();
      if (damage.count > 0) {
        if (damage_.count == 0) damage_.first = damage.first;
        damage_.count += damage.count;
      }
      ++current_;
    }
    return false;
  }

 private:
  struct Part {
    fs::path file;
    std::unique_ptr<BagReader> reader;
    std::vector<std::size_t> topics;  ///< place in ours
    std::size_t messages = 0;
  };

  void open_file(const fs::path& file) {
    require_reachable(file);
    const BagCompression compression = compression_of_file(file);
    // SQLite opens only what has a name.
    const bool has_name = !is_pipe(file) || !is_sqlite(file);
    if (compression == BagCompression::kNone && has_name) {
      parts_.push_back({file, open_plain(readable_path(file), file), {}});
      return;
    }
    // The readers keep the unpacked file open, so its name can go at once.
    const UnpackedFile unpacked(file);
    if (!unpacked.damage().empty()) damage_.add(unpacked.damage());
    parts_.push_back({file, open_plain(unpacked.path(), file), {}});
    if (compression != BagCompression::kNone) packed_file_ = compression;
  }

  void map_topics(Part& part) {
    const auto& theirs = part.reader->topics();
    while (part.topics.size() < theirs.size()) {
      const BagTopic& topic = theirs[part.topics.size()];
      const auto found = std::find_if(topics_.begin(), topics_.end(), [&](const BagTopic& known) {
        return known.name == topic.name && known.type == topic.type;
      });
      part.topics.push_back(static_cast<std::size_t>(found - topics_.begin()));
      if (found == topics_.end()) topics_.push_back(topic);
    }
  }

  /// False when the message is damaged. CDR begins with a zero byte and a frame does not, so a
  /// packed message is known even where metadata.yaml is lost.
  bool unpack(Part& part, BagMessage& message) {
    ++part.messages;
    const BagTopic& topic = topics_[message.topic];
    if (!packed_messages_ && topic.serialization_format != "cdr") return true;
    const BagCompression compression = compression_of(message.data);
    if (compression == BagCompression::kNone) return true;
    packed_messages_ = true;
    std::string error;
    Bytes plain = decompress(message.data, compression, kLargestMessage, error);
    if (!error.empty()) {
      damage_.add(part.file.string() + ": " + topic.name + ", message " +
                  std::to_string(part.messages) + " of the file: cannot be unpacked: " + error);
      return false;
    }
    message.data = std::move(plain);
    return true;
  }

  std::vector<Part> parts_;
  std::size_t current_ = 0;
  std::vector<BagTopic> topics_;
  BagDamage damage_;
  BagCompression packed_file_ = BagCompression::kNone;
  bool packed_messages_ = false;
};

}  // namespace

bool is_bag(const fs::path& path) {
  return fs::is_directory(path) || is_mcap(path) || is_sqlite(path) || is_ros1_bag(path) ||
         compression_of_file(path) != BagCompression::kNone;
}

std::unique_ptr<BagReader> BagReader::open(const fs::path& path) {
  if (fs::is_directory(path)) return std::make_unique<BagFiles>(bag_files(path));
  return std::make_unique<BagFiles>(BagFolderFiles{{path}, false});
}

}  // namespace strata::log
