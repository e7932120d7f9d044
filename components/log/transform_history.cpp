// SPDX-License-Identifier: Apache-2.0
#include "components/log/transform_history.hpp"

#include <algorithm>
#include <utility>

namespace strata::log {

void TransformHistory::add_fixed(const std::string& parent, const std::string& child,
                                 const Pose3& pose) {
  fixed_.add(parent, child, pose);
  fixed_parents_[frame_name(child)] = frame_name(parent);
}

void TransformHistory::add(const std::string& parent, const std::string& child, Stamp stamp,
                           const Pose3& pose) {
  Link& link = links_[frame_name(child)];
  const std::string parent_name = frame_name(parent);
  if (link.parent != parent_name) link = {parent_name, {}, {}, {}};
  if (keep_s_ <= 0.0) return insert(link, {stamp, pose});
  const SetBackWatch::Verdict verdict = link.watch.add(stamp);
  const std::optional<Sample> suspect = std::exchange(link.suspect, std::nullopt);
  if (verdict == SetBackWatch::Verdict::kSetBack) link.samples.clear();
  if (suspect) insert(link, *suspect);
  if (verdict == SetBackWatch::Verdict::kSuspect) {
    link.suspect = Sample{stamp, pose};
  } else {
    insert(link, {stamp, pose});
  }
  forget(link);
}

void TransformHistory::insert(Link& link, const Sample& sample) {
  const auto place = std::upper_bound(link.samples.begin(), link.samples.end(), sample.stamp,
                                      [](Stamp s, const Sample& other) { return s < other.stamp; });
  link.samples.insert(place, sample);
}

void TransformHistory::forget(Link& link) const {
  const Stamp oldest = link.samples.back().stamp - Duration::from_seconds(keep_s_);
  // In pieces, so that forgetting costs little.
  if ((oldest - link.samples.front().stamp).seconds() < keep_s_) return;
  std::erase_if(link.samples, [&](const Sample& sample) { return sample.stamp < oldest; });
}

std::optional<Pose3> TransformHistory::at(const Link& link, Stamp stamp) const {
  const auto after =
      std::lower_bound(link.samples.begin(), link.samples.end(), stamp,
                       [](const Sample& sample, Stamp s) { return sample.stamp < s; });
  if (after != link.samples.end() && after->stamp == stamp) return after->pose;
  if (after == link.samples.begin() || after == link.samples.end()) return std::nullopt;
  const Sample& a = *(after - 1);
  const Sample& b = *after;
  const double gap_s = (b.stamp - a.stamp).seconds();
  if (gap_s > max_gap_s_) return std::nullopt;
  const double t = (stamp - a.stamp).seconds() / gap_s;
  return Pose3{(1.0 - t) * a.pose.translation + t * b.pose.translation,
               a.pose.rotation.slerp(t, b.pose.rotation)};
}

std::optional<Pose3> TransformHistory::find(const std::string& target, const std::string& source,
                                            Stamp stamp) const {
  TransformTree tree = fixed_;
  for (const auto& [child, link] : links_) {
    if (const auto pose = at(link, stamp)) tree.add(link.parent, child, *pose);
  }
  return tree.find(target, source);
}

bool TransformHistory::knows(const std::string& frame) const {
  const std::string name = frame_name(frame);
  const auto names = [&](const auto& entry) { return entry.first == name; };
  return std::any_of(links_.begin(), links_.end(), names) ||
         std::any_of(links_.begin(), links_.end(),
                     [&](const auto& entry) { return entry.second.parent == name; }) ||
         std::any_of(fixed_parents_.begin(), fixed_parents_.end(), names) ||
         std::any_of(fixed_parents_.begin(), fixed_parents_.end(),
                     [&](const auto& entry) { return entry.second == name; });
}

}  // namespace strata::log
