// SPDX-License-Identifier: Apache-2.0
#include "components/clouds/cloud_reader.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <octomap/octomap_types.h>

#include "components/clouds/bag_clouds.hpp"
#include "components/log/spooled_input.hpp"
#include "components/log/text.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::clouds {
namespace {

/// A damaged length must not make us take memory without end.
constexpr std::uint32_t kMaxPoints = 200'000'000;

Pose3 pose_of(const octomath::Pose6D& pose) {
  const octomath::Vector3& t = pose.trans();
  const octomath::Quaternion& q = pose.rot();
  Pose3 result;
  result.translation = Eigen::Vector3f(t.x(), t.y(), t.z()).cast<double>();
  result.rotation = Eigen::Quaternionf(q.u(), q.x(), q.y(), q.z()).cast<double>();
  return result;
}

bool parse_floats(const std::vector<std::string_view>& words, std::size_t first, std::size_t count,
                  float* values) {
  if (words.size() < first + count) return false;
  for (std::size_t i = 0; i < count; ++i) {
    const auto value = log::parse_float(words[first + i]);
    if (!value) return false;
    values[i] = *value;
  }
  return true;
}

class TextLogReader final : public CloudReader {
 public:
  explicit TextLogReader(const fs::path& path) : lines_(path) {
    report_.format = "OctoMap log";
    read_to_node();
  }

  bool next(volume::Cloud& cloud) override {
    if (!pose_) return false;
    cloud.map_from_sensor = *pose_;
    cloud.stamp = Stamp::from_seconds(static_cast<double>(report_.clouds));
    cloud.points_m.clear();
    points_ = &cloud.points_m;
    pose_.reset();
    read_to_node();
    points_ = nullptr;
    ++report_.clouds;
    return true;
  }

 private:
  /// Up to the next line that gives a pose; points go to `points_`, or are counted when there is
  /// none.
  void read_to_node() {
    while (lines_.next(line_)) {
      log::split(line_, words_);
      if (words_.empty() || words_[0].front() == '#') continue;
      if (words_[0] == "NODE") {
        if (read_pose()) return;
        points_ = nullptr;
      } else {
        read_point();
      }
    }
    if (!lines_.damage().empty()) bad(lines_.place() + ": " + lines_.damage());
  }

  bool read_pose() {
    float v[6] = {};
    bool good = parse_floats(words_, 1, 6, v);
    for (const float value : v) good = good && std::isfinite(value);
    if (!good) {
      ++report_.clouds_without_pose;
      bad(lines_.place() + ": NODE without a pose of 6 numbers; its points are left out");
      return false;
    }
    pose_ = pose_of(octomath::Pose6D(v[0], v[1], v[2], static_cast<double>(v[3]),
                                     static_cast<double>(v[4]), static_cast<double>(v[5])));
    return true;
  }

  void read_point() {
    float v[3] = {};
    if (!parse_floats(words_, 0, 3, v)) {
      bad(lines_.place() + ": is neither NODE nor a point of 3 numbers");
    } else if (points_ == nullptr) {
      ++report_.points_without_pose;
    } else {
      points_->push_back({v[0], v[1], v[2]});
    }
  }

  log::LineReader lines_;
  std::string line_;
  std::vector<std::string_view> words_;
  std::optional<Pose3> pose_;
  std::vector<Eigen::Vector3f>* points_ = nullptr;
};

/// Numbers of clouds, points and edges are 32 bits, coordinates doubles behind their count.
class ScanGraphReader final : public CloudReader {
 public:
  explicit ScanGraphReader(const fs::path& path)
      : place_(path.string()),
        size_(fs::file_size(log::readable_path(path))),
        in_(log::readable_path(path), std::ios::binary) {
    report_.format = "OctoMap scan graph";
    left_ = number().value_or(0);
  }

  bool next(volume::Cloud& cloud) override {
    while (left_ > 0) {
      --left_;
      const auto outcome = read_cloud(cloud);
      if (!outcome) {
        bad(place_ + ": is cut or damaged after byte " + std::to_string(offset_));
        left_ = 0;
        return false;
      }
      if (*outcome) return true;
    }
    return false;
  }

 private:
  /// Nothing when the file ends too soon; false when the pose makes no sense.
  std::optional<bool> read_cloud(volume::Cloud& cloud) {
    const auto count = number();
    if (!count || *count > kMaxPoints || offset_ + std::uintmax_t{*count} * 28 > size_) {
      return std::nullopt;
    }
    cloud.points_m.resize(*count);
    for (Eigen::Vector3f& point : cloud.points_m) {
      double v[3] = {};
      if (!doubles(3, v)) return std::nullopt;
      point = {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
    }
    double t[3] = {};
    double q[4] = {};
    if (!doubles(3, t) || !doubles(4, q)) return std::nullopt;
    const auto id = number();
    if (!id) return std::nullopt;
    const auto f = [](double value) { return static_cast<float>(value); };
    cloud.map_from_sensor = pose_of({octomath::Vector3(f(t[0]), f(t[1]), f(t[2])),
                                     octomath::Quaternion(f(q[0]), f(q[1]), f(q[2]), f(q[3]))});
    const bool is_pose = cloud.map_from_sensor.translation.allFinite() &&
                         cloud.map_from_sensor.rotation.coeffs().allFinite();
    if (!is_pose) {
      ++report_.clouds_without_pose;
      report_.points_without_pose += *count;
      bad(place_ + ": cloud " + std::to_string(*id) + ": its pose is not finite");
      return false;
    }
    cloud.stamp = Stamp::from_seconds(static_cast<double>(report_.clouds++));
    return true;
  }

  template <typename T>
  bool take(T& value) {
    char bytes[sizeof(T)];
    if (!in_.read(bytes, sizeof bytes)) return false;
    std::memcpy(&value, bytes, sizeof bytes);
    offset_ += sizeof bytes;
    return true;
  }
  std::optional<std::uint32_t> number() {
    std::uint32_t value = 0;
    return take(value) ? std::optional(value) : std::nullopt;
  }
  bool doubles(std::uint32_t count, double* values) {
    const auto said = number();
    if (!said || *said != count) return false;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (!take(values[i])) return false;
    }
    return true;
  }

  std::string place_;
  std::uintmax_t size_ = 0;
  std::uintmax_t offset_ = 0;
  std::ifstream in_;
  std::uint32_t left_ = 0;
};

bool is_text_log(const fs::path& path) {
  log::LineReader lines(path);
  std::string line;
  std::vector<std::string_view> words;
  for (int i = 0; i < 400 && lines.next(line); ++i) {
    if (line.size() > 100'000) return false;
    log::split(line, words);
    if (!words.empty() && words[0] == "NODE") return true;
  }
  return false;
}

/// Whether the first cloud of a scan graph can lie in the file as its numbers say.
bool is_scan_graph(const fs::path& path) {
  std::ifstream in(log::readable_path(path), std::ios::binary);
  std::uint32_t head[3] = {};
  char bytes[sizeof head];
  if (!in.read(bytes, sizeof bytes)) return false;
  std::memcpy(head, bytes, sizeof bytes);
  return head[0] > 0 && head[0] < 1'000'000 && head[1] > 0 && head[1] <= kMaxPoints && head[2] == 3;
}

}  // namespace

std::unique_ptr<CloudReader> CloudReader::open(const fs::path& path,
                                               const CloudReadOptions& options) {
  log::require_reachable(path);
  if (!fs::is_directory(path)) {
    if (is_scan_graph(path)) return std::make_unique<ScanGraphReader>(path);
    if (is_text_log(path)) return std::make_unique<TextLogReader>(path);
  }
  if (is_bag(path)) return open_bag_clouds(path, options);
  throw InputError(path.string(), "is no 3-D log that is known here",
                   "give an OctoMap log (NODE lines), a scan graph, or a bag with PointCloud2");
}

}  // namespace strata::clouds
