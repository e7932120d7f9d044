// SPDX-License-Identifier: Apache-2.0
/// Bags as raw messages: rosbag2's, SQLite and MCAP, reading and writing; ROS 1's, reading.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/interface.hpp"
#include "core/base/time.hpp"

namespace strata::log {

/// The serialization format of messages that ROS 1 serialized and that are not known here.
inline constexpr const char* kRos1Format = "ros1";

struct BagTopic {
  std::string name;  ///< "/scan"
  std::string type;  ///< "sensor_msgs/msg/LaserScan"
  std::string serialization_format = "cdr";
  std::string offered_qos_profiles = {};  ///< YAML text, as rosbag2 keeps it
  /// What the bag itself says about the type; empty where it says nothing. A writer puts the
  /// definition of the types in idl/ itself.
  std::string definition = {};
  std::string definition_encoding = "ros2msg";  ///< or "ros2idl"
  std::string type_hash = {};                   ///< "RIHS01_..."; as the definition
};

struct BagMessage {
  std::size_t topic = 0;  ///< place in BagReader::topics()
  Stamp stamp;            ///< when it was recorded
  std::vector<std::uint8_t> data;
};

/// What reading could not make use of.
struct BagDamage {
  std::size_t count = 0;  ///< damaged places: chunks, records, rows
  std::string first;      ///< where the first one is and why
  void add(const std::string& place_and_reason) {
    if (count++ == 0) first = place_and_reason;
  }
};

/// Messages in order of their stamps, from a bag folder (with or without metadata.yaml), a .db3 or
/// a .mcap file, or a ROS 1 .bag; told by content. Messages of ROS 1 come out as ROS 2 has them,
/// where their type is known here (types of scans, clouds, images, odometry, poses, tf and maps).
class BagReader : public Interface {
 public:
  /// Throws InputError when there is nothing to read at all. What rosbag2 compressed (whole files
  /// or single messages, zstd or lz4) is unpacked, told by content.
  [[nodiscard]] static std::unique_ptr<BagReader> open(const std::filesystem::path& path);

  /// Grows while reading damaged MCAP files without summary; places stay valid.
  [[nodiscard]] virtual const std::vector<BagTopic>& topics() const = 0;
  /// The next message; false at the end. Damaged parts are skipped and counted.
  virtual bool next(BagMessage& message) = 0;
  [[nodiscard]] virtual const BagDamage& damage() const = 0;
  /// How it is stored, for people: "2 files, SQLite schema 3 (humble), files packed with zstd".
  [[nodiscard]] virtual std::string description() const = 0;
};

/// Whether it is what BagReader::open opens: a folder, or a file whose first bytes say so.
[[nodiscard]] bool is_bag(const std::filesystem::path& path);

enum class BagStorage { kSqlite3, kMcap };
enum class BagCompression { kNone, kZstd, kLz4 };
/// What rosbag2 calls compression_mode; always zstd, the only one that it can read everywhere.
enum class BagPacking { kNone, kFile, kMessage };

struct BagOptions {
  BagStorage storage = BagStorage::kSqlite3;
  BagCompression chunks = BagCompression::kNone;  ///< of MCAP; SQLite has none
  BagPacking packing = BagPacking::kNone;
  int sqlite_schema = 3;  ///< 3 as Humble, 4 as Iron and later, with message definitions
  /// A file that holds this much (before packing), or is written for this time, is followed by
  /// another; 0 does not split.
  std::uint64_t split_bytes = 0;
  Duration split_after{0};
};

/// What a bag lacks because its disk was full.
struct BagGap {
  std::size_t lost = 0;  ///< messages, since the bag was begun
  bool lasts = false;    ///< nothing can be written now
};

/// That a bag could be begun there: the folder is empty or missing. Throws OutputError.
void require_new_folder(const std::filesystem::path& folder);

/// Writes a bag folder as it goes: what was written more than a second or a megabyte ago survives
/// a crash. `close` completes it (summary, metadata.yaml); the destructor does, ignoring errors.
/// What is written after `close` goes to another file of the same bag, until the next `close`.
///
/// A file that cannot be written to its end, as on a full disk, keeps what is in it. What is not,
/// and what comes then, waits in memory, a megabyte and a message at most; more is lost and
/// counted. With every `flush` and `close`, and twice a second with a `write`, another file of the
/// bag is tried, which begins with what waits.
class BagWriter {
 public:
  /// Throws OutputError when the folder exists and is not empty, or cannot be made.
  BagWriter(const std::filesystem::path& folder, const BagOptions& options);
  BagWriter(const std::filesystem::path& folder, BagStorage storage,
            BagCompression compression = BagCompression::kNone)
      : BagWriter(folder, BagOptions{.storage = storage, .chunks = compression}) {}
  ~BagWriter();
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;

  /// Adding a name again gives its place again. A file that cannot take it fails: the next `write`
  /// says so.
  std::size_t add_topic(const BagTopic& topic);
  /// Throws OutputError when the file fails (full disk, ...), and when the message is lost because
  /// no other can be begun. Any order of stamps. at: by what clock `split_after` goes; where
  /// stamps come from clocks that differ, one that is told apart from them.
  void write(std::size_t topic, Stamp stamp, std::span<const std::uint8_t> cdr, Stamp at);
  void write(std::size_t topic, Stamp stamp, std::span<const std::uint8_t> cdr) {
    write(topic, stamp, cdr, stamp);
  }
  /// Brings everything written so far to the file, for whoever waits longer than a second between
  /// two messages. Throws OutputError as long as that cannot be done.
  void flush();
  /// Throws OutputError when the bag is not complete; it may be tried again.
  void close();
  [[nodiscard]] BagGap gap() const;

  /// One storage file; implemented for SQLite and MCAP.
  class File : public Interface {
   public:
    virtual void add_topic(const BagTopic& topic) = 0;
    virtual void write(std::size_t topic, Stamp stamp, std::span<const std::uint8_t> cdr) = 0;
    virtual void flush() = 0;
    /// Messages, from the first, that it keeps whatever fails from now on.
    [[nodiscard]] virtual std::size_t saved() const = 0;
    /// After a failure: forgets what is not saved, so that `close` may be called.
    virtual void give_up() = 0;
    /// metadata: what metadata.yaml would say of the bag now.
    virtual void close(const std::string& metadata) = 0;
  };

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace strata::log
