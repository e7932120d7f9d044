// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/node_pattern.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

#include "components/settings/config_reader.hpp"
#include "core/base/split.hpp"

namespace strata::runtime {
namespace {

constexpr const char* kOneSegment = "*";
constexpr const char* kAnyNumber = "**";

bool is_name(const std::string& segment) { return segment != kOneSegment && segment != kAnyNumber; }

std::vector<std::string> segments_of(const std::string& path) { return split(path, '/'); }

/// O(pattern names): `reached[j]` says whether the pattern so far can end before name j.
bool matches(std::span<const std::string> pattern, std::span<const std::string> names) {
  std::vector<bool> reached(names.size() + 1, false);
  reached[0] = true;
  for (const std::string& segment : pattern) {
    std::vector<bool> next(names.size() + 1, false);
    for (std::size_t j = 0; j <= names.size(); ++j) {
      if (segment == kAnyNumber) {
        next[j] = reached[j] || (j > 0 && next[j - 1]);
      } else {
        next[j] = j > 0 && reached[j - 1] && (segment == kOneSegment || segment == names[j - 1]);
      }
    }
    reached = std::move(next);
  }
  return reached.back();
}

std::string without_digits(std::string text) {
  std::erase_if(text, [](char c) { return c >= '0' && c <= '9'; });
  return text;
}

bool is_misspelled(const std::string& text, const std::string& meant) {
  if (text == meant || without_digits(text) == without_digits(meant)) return false;
  const std::size_t allowed = std::max<std::size_t>(1, meant.size() / 6);
  return settings::detail::edit_distance(text, meant) <= allowed;
}

std::string joined(std::span<const std::string> segments) {
  std::string text;
  for (const std::string& segment : segments) text += "/" + segment;
  return text;
}

}  // namespace

NodePattern::NodePattern(std::string text) : text_(std::move(text)), segments_(segments_of(text_)) {
  const bool is_bare_name = segments_.size() == 1 && text_.front() != '/' && is_name(segments_[0]);
  if (is_bare_name) segments_.insert(segments_.begin(), kAnyNumber);
}

std::optional<NodePattern::Specificity> NodePattern::match(const std::string& full_name) const {
  const std::vector<std::string> names = segments_of(full_name);
  if (!matches(segments_, names)) return std::nullopt;
  Specificity result;
  result.names_node = names_node();
  for (const std::string& segment : segments_) {
    result.names += is_name(segment) ? 1 : 0;
    result.fewer_any_number -= segment == kAnyNumber ? 1 : 0;
    result.fewer_one_segment -= segment == kOneSegment ? 1 : 0;
  }
  // In ROS 2 a name without a namespace is one in the root namespace, and so as good as a full one.
  if (text_ == names.back()) result.fewer_any_number = names.size() == 1 ? 0 : -1;
  return result;
}

bool NodePattern::names_node() const { return !segments_.empty() && is_name(segments_.back()); }

bool NodePattern::is_typo_of(const std::string& full_name) const {
  if (!names_node()) return false;
  const std::vector<std::string> names = segments_of(full_name);
  if (is_misspelled(joined(segments_), joined(names))) return true;
  // A namespace that is right, wild or left out with a name that is not.
  std::vector<std::string> corrected = segments_;
  corrected.back() = names.back();
  return matches(corrected, names) && is_misspelled(segments_.back(), names.back());
}

}  // namespace strata::runtime
