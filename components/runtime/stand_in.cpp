// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/stand_in.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "components/runtime/parameters.hpp"
#include "components/settings/config_writer.hpp"
#include "components/settings/yaml_document.hpp"
#include "core/base/error.hpp"
#include "core/base/split.hpp"

namespace strata::runtime {
namespace {

using Fate = TranslatedParameter::Fate;

YAML::Node scalar(const std::string& text) { return YAML::Node(text); }

/// So that complaints about it name the line that it comes from.
void place_as(const YAML::Node& original, YAML::Node value) {
  value.SetTag(original.Tag());
  for (std::size_t i = 0; value.IsSequence() && i < value.size(); ++i) {
    YAML::Node item = value[i];
    item.SetTag(original.Tag());
  }
}

/// The names of all values of a map, "initial_pose.x", in their order; those below a name in
/// `whole` are left out.
void list_names(const YAML::Node& map, const std::string& prefix,
                const std::set<std::string>& whole, std::vector<std::string>& names) {
  for (const auto& item : map) {
    const std::string name = prefix + item.first.Scalar();
    if (item.second.IsMap() && item.second.size() > 0 && !whole.contains(name)) {
      list_names(item.second, name + ".", whole, names);
    } else {
      names.push_back(name);
    }
  }
}

std::string counted(const std::vector<TranslatedParameter>& translated, Fate fate) {
  std::set<std::string> names;
  for (const TranslatedParameter& one : translated) {
    if (one.fate == fate) names.insert(one.name);
  }
  return std::to_string(names.size());
}

}  // namespace

YAML::Node Translator::at(const YAML::Node& root, const std::string& path) {
  YAML::Node node(YAML::NodeType::Undefined);
  node.reset(root);
  for (const std::string& key : split(path, '.')) {
    if (!node.IsDefined() || !node.IsMap()) return YAML::Node(YAML::NodeType::Undefined);
    const YAML::Node child = std::as_const(node)[key];
    if (!child.IsDefined()) return YAML::Node(YAML::NodeType::Undefined);
    node.reset(child);
  }
  return node;
}

YAML::Node Translator::take(const std::string& name) {
  YAML::Node node = at(given_, name);
  if (node.IsDefined()) taken_.insert(name);
  return node;
}

void Translator::add(const std::string& name, Fate fate, const std::string& text) {
  const YAML::Node node = take(name);
  if (!node.IsDefined()) return;
  translated_.push_back({fate, settings::place_of(node, "", name), name, "", text, {}});
}

void Translator::add_mapped(const std::string& name, const std::string& path,
                            const YAML::Node& value, const std::string& text) {
  const YAML::Node node = take(name);
  if (!node.IsDefined()) return;
  place_as(node, value);
  translated_.push_back(
      {Fate::kMapped, settings::place_of(node, "", name), name, path, text, value});
}

void Translator::map(const std::string& name, const std::string& path, bool value) {
  const std::string text = settings::detail::yaml_text(value);
  add_mapped(name, path, scalar(text), text);
}
void Translator::map(const std::string& name, const std::string& path, int value) {
  const std::string text = settings::detail::yaml_text(value);
  add_mapped(name, path, scalar(text), text);
}
void Translator::map(const std::string& name, const std::string& path, double value) {
  const std::string text = settings::detail::yaml_text(value);
  add_mapped(name, path, scalar(text), text);
}
void Translator::map(const std::string& name, const std::string& path, const std::string& value) {
  add_mapped(name, path, scalar(value), settings::detail::yaml_text(value));
}
void Translator::map(const std::string& name, const std::string& path, const char* value) {
  map(name, path, std::string(value));
}
void Translator::map(const std::string& name, const std::string& path,
                     const std::vector<double>& value) {
  YAML::Node list(YAML::NodeType::Sequence);
  for (const double item : value) list.push_back(scalar(settings::detail::yaml_text(item)));
  add_mapped(name, path, list, settings::detail::yaml_text(value));
}

bool Translator::is_own(const std::string& path) const {
  for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', dot + 1)) {
    const YAML::Node group = at(own_, path.substr(0, dot));
    if (group.IsDefined() && !group.IsMap() && !group.IsNull()) return true;
  }
  return at(own_, path).IsDefined();
}

void Translator::ignore(const std::string& name, const std::string& why) {
  add(name, Fate::kIgnored, why);
}

void Translator::warn(const std::string& name, const std::string& why) {
  add(name, Fate::kWarned, why);
}

void Translator::refuse(const std::string& name, const std::string& problem,
                        const std::string& remedy) const {
  throw ConfigError(settings::place_of(at(given_, name), "", name), problem, remedy);
}

std::vector<TranslatedParameter> Translator::finish(const std::vector<std::string>& names) {
  std::vector<std::string> in_order;
  list_names(given_, "", taken_, in_order);
  for (const std::string& name : in_order) {
    if (taken_.contains(name)) continue;
    add(name, Fate::kUnknown, settings::detail::suggestion(name, names, "parameters"));
  }
  // Into another list, since assigning one YAML::Node to another ties the two together.
  std::vector<TranslatedParameter> sorted;
  for (const std::string& name : in_order) {
    for (const TranslatedParameter& one : translated_) {
      if (one.name == name) sorted.push_back(one);
    }
  }
  return sorted;
}

const StandIn* find_stand_in(const StandIns& stand_ins, const std::string& component_type) {
  const auto found = std::find_if(stand_ins.begin(), stand_ins.end(), [&](const StandIn& one) {
    return one.component_type == component_type;
  });
  return found == stand_ins.end() ? nullptr : &*found;
}

bool has_parameter(const StandIn& stand_in, const std::string& first_name) {
  return std::any_of(stand_in.names.begin(), stand_in.names.end(), [&](const std::string& name) {
    return name == first_name || name.starts_with(first_name + ".");
  });
}

std::vector<TranslatedParameter> translate(const StandIn& stand_in, const YAML::Node& given,
                                           YAML::Node& own) {
  Translator translator(given, own);
  stand_in.translate(translator);
  std::vector<TranslatedParameter> translated = translator.finish(stand_in.names);
  const Translator before(given, YAML::Clone(own));  // where something stands
  for (TranslatedParameter& one : translated) {
    if (one.fate != Fate::kMapped) continue;
    if (before.is_own(one.path)) {
      one.fate = Fate::kOverruled;
    } else {
      set_in_yaml(own, one.path, one.value);
    }
  }
  return translated;
}

std::vector<std::string> notes_of(const std::vector<TranslatedParameter>& translated,
                                  const StandIn& stand_in, const std::string& component,
                                  const std::string& place) {
  if (translated.empty()) return {};
  std::vector<std::string> notes = {place + ": what is for " + stand_in.node + " is for " +
                                    component + ": " + counted(translated, Fate::kMapped) +
                                    " parameters mapped, " + counted(translated, Fate::kOverruled) +
                                    " given otherwise, " + counted(translated, Fate::kIgnored) +
                                    " without meaning here; `strata run --check` lists them"};
  for (const TranslatedParameter& one : translated) {
    if (one.fate == Fate::kWarned) {
      notes.push_back(one.place + ": " + one.name + ": " + one.text);
    } else if (one.fate == Fate::kUnknown) {
      notes.push_back(one.place + ": " + stand_in.node + " has no parameter '" + one.name + "'; " +
                      one.text);
    }
  }
  return notes;
}

}  // namespace strata::runtime
