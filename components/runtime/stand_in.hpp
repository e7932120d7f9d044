// SPDX-License-Identifier: Apache-2.0
/// Components that stand in for other projects' nodes (the localizer for nav2's amcl), and what the
/// parameters of those nodes are in our names.
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "components/settings/config_reader.hpp"

namespace strata::runtime {

/// What became of one parameter of the other node.
struct TranslatedParameter {
  enum class Fate {
    kMapped,     ///< to ours
    kOverruled,  ///< ours is given by the composition, --set or an entry in our names
    kIgnored,    ///< it has no meaning here
    kWarned,     ///< ... and the user should hear of that at every start
    kUnknown,    ///< the other node has no such parameter either
  };
  Fate fate = Fate::kMapped;
  std::string place;  ///< "file:line"
  std::string name;   ///< "initial_pose.x"
  std::string path;   ///< mapped, overruled: ours, "localizer.gating.translation_m"
  std::string text;   ///< mapped, overruled: our value; else why, or what was meant
  YAML::Node value;   ///< mapped, overruled
};

/// Takes the parameters of the other node one by one.
class Translator {
 public:
  /// given: without dots in its keys, nodes with their places (copy_with_places). own: what is
  /// given in our names.
  Translator(const YAML::Node& given, const YAML::Node& own) : given_(given), own_(own) {}

  /// The value of "initial_pose.x"; nothing when it is not given. Throws ConfigError (file:line)
  /// for one of another type.
  template <typename T>
  [[nodiscard]] std::optional<T> read(const std::string& name) {
    const YAML::Node node = take(name);
    if (!node.IsDefined()) return std::nullopt;
    T value{};
    settings::detail::read_value(node, "", name, value);
    return value;
  }
  /// What is given in our names; `usual` when nothing is.
  template <typename T>
  [[nodiscard]] T own(const std::string& path, T usual) const {
    const YAML::Node node = at(own_, path);
    if (node.IsDefined()) settings::detail::read_value(node, "", path, usual);
    return usual;
  }
  /// Whether something stands there, or a value in the place of its group.
  [[nodiscard]] bool is_own(const std::string& path) const;
  /// Our parameter `path` is `value`, because of `name`.
  void map(const std::string& name, const std::string& path, bool value);
  void map(const std::string& name, const std::string& path, int value);
  void map(const std::string& name, const std::string& path, double value);
  void map(const std::string& name, const std::string& path, const std::string& value);
  void map(const std::string& name, const std::string& path, const char* value);
  void map(const std::string& name, const std::string& path, const std::vector<double>& value);
  /// The same value, when it is given.
  template <typename T>
  void map_as_it_is(const std::string& name, const std::string& path) {
    if (const auto value = read<T>(name)) map(name, path, *value);
  }
  /// Says why it has no meaning here, when it is given.
  void ignore(const std::string& name, const std::string& why);
  /// The same where the user should hear of it at every start.
  void warn(const std::string& name, const std::string& why);
  /// Throws ConfigError at the place of `name`.
  [[noreturn]] void refuse(const std::string& name, const std::string& problem,
                           const std::string& remedy) const;

  /// What became of all, in the order of the file; what nobody asked for is unknown. names: of the
  /// other node's parameters, to say what was meant.
  [[nodiscard]] std::vector<TranslatedParameter> finish(const std::vector<std::string>& names);

 private:
  static YAML::Node at(const YAML::Node& root, const std::string& path);
  YAML::Node take(const std::string& name);
  void add_mapped(const std::string& name, const std::string& path, const YAML::Node& value,
                  const std::string& text);
  void add(const std::string& name, TranslatedParameter::Fate fate, const std::string& text);

  const YAML::Node given_;  // const: looking a key up must not make it
  const YAML::Node own_;
  std::set<std::string> taken_;
  std::vector<TranslatedParameter> translated_;
};

/// A node that a component of ours can stand in for.
struct StandIn {
  std::string node;                ///< "amcl"
  std::string component_type;      ///< "strata::Localizer"
  std::vector<std::string> names;  ///< of the node's parameters, "initial_pose.x"
  std::function<void(Translator&)> translate;
};
using StandIns = std::vector<StandIn>;

/// Null when the component stands in for nobody.
[[nodiscard]] const StandIn* find_stand_in(const StandIns& stand_ins,
                                           const std::string& component_type);
/// Whether a key of the node's parameters has this name or begins with it ("initial_pose").
[[nodiscard]] bool has_parameter(const StandIn& stand_in, const std::string& first_name);

/// Translates, and puts what was mapped into `own` where nothing stands yet; what something does is
/// overruled. Throws ConfigError.
[[nodiscard]] std::vector<TranslatedParameter> translate(const StandIn& stand_in,
                                                         const YAML::Node& given, YAML::Node& own);

/// What a user is to hear of that at every start, one line each. place: of the parameter file.
[[nodiscard]] std::vector<std::string> notes_of(const std::vector<TranslatedParameter>& translated,
                                                const StandIn& stand_in,
                                                const std::string& component,
                                                const std::string& place);

}  // namespace strata::runtime
