// SPDX-License-Identifier: Apache-2.0
#include "components/log/transform_tree.hpp"

#include <algorithm>
#include <cstddef>

namespace strata::log {

std::string frame_name(const std::string& frame) {
  return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

void TransformTree::add(const std::string& parent, const std::string& child,
                        const Pose3& parent_from_child) {
  links_[frame_name(child)] = {frame_name(parent), parent_from_child};
}

std::optional<Pose3> TransformTree::find(const std::string& target,
                                         const std::string& source) const {
  // From each frame up to its root: ancestor -> ancestor_from_frame.
  const auto climb = [this](const std::string& from) {
    std::vector<std::pair<std::string, Pose3>> path{{frame_name(from), Pose3{}}};
    // At most one step a link, so that a damaged, circular tree ends too.
    for (std::size_t step = 0; step < links_.size(); ++step) {
      const auto link = links_.find(path.back().first);
      if (link == links_.end()) break;
      path.emplace_back(link->second.first, link->second.second * path.back().second);
    }
    return path;
  };
  const auto from_target = climb(target);
  for (const auto& [ancestor, ancestor_from_source] : climb(source)) {
    for (const auto& [other, ancestor_from_target] : from_target) {
      if (other == ancestor) return inverse(ancestor_from_target) * ancestor_from_source;
    }
  }
  return std::nullopt;
}

bool TransformTree::knows(const std::string& frame) const {
  const std::string name = frame_name(frame);
  return std::any_of(links_.begin(), links_.end(), [&](const auto& link) {
    return link.first == name || link.second.first == name;
  });
}

std::string TransformTree::root_of(const std::string& frame) const {
  std::string root = frame_name(frame);
  for (std::size_t step = 0; step < links_.size(); ++step) {  // a circular tree ends too
    const auto link = links_.find(root);
    if (link == links_.end()) break;
    root = link->second.first;
  }
  return root;
}

}  // namespace strata::log
