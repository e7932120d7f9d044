// SPDX-License-Identifier: Apache-2.0
/// Which nodes an entry of a ROS 2 parameter file is for.
#pragma once

#include <compare>
#include <optional>
#include <string>
#include <vector>

namespace strata::runtime {

/// "/robot1/matcher", "matcher" in any namespace, or with wildcards as in ROS 2: "*" stands for one
/// segment, "**" for any number of them, none included ("/*/matcher", "/robot1/**").
class NodePattern {
 public:
  explicit NodePattern(std::string text);

  /// How much a pattern says of a node that it matches; greater is more specific.
  struct Specificity {
    bool names_node = false;    ///< its last segment is a name
    int names = 0;              ///< segments that are names
    int fewer_any_number = 0;   ///< minus the number of "**"
    int fewer_one_segment = 0;  ///< minus the number of "*"
    auto operator<=>(const Specificity&) const = default;
  };
  /// Nothing where the pattern does not match. full_name: "/robot1/matcher".
  [[nodiscard]] std::optional<Specificity> match(const std::string& full_name) const;
  /// Whether it names nodes, and not all nodes of a namespace.
  [[nodiscard]] bool names_node() const;
  /// Whether it is likely to be meant for this node and misspelled: an edit in six letters, at
  /// least one, apart from it. Names that differ in their digits only ("robot1", "robot2") are
  /// different names.
  [[nodiscard]] bool is_typo_of(const std::string& full_name) const;
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
  std::vector<std::string> segments_;
};

}  // namespace strata::runtime
