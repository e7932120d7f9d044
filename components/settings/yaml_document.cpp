// SPDX-License-Identifier: Apache-2.0
#include "components/settings/yaml_document.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <sstream>
#include <string_view>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/parser.h>

#include "components/settings/text_file.hpp"
#include "core/base/error.hpp"

namespace strata::settings {
namespace {

/// Deeper values than this are refused: aliases can nest without end.
constexpr int kMaxDepth = 64;

/// One step of a key path: a key of a map or a place in a list.
struct PathStep {
  std::string key;
  std::optional<std::size_t> index;
};

[[noreturn]] void refuse(const std::string& option, const std::string& what,
                         const std::string& remedy) {
  throw ConfigError("--set " + option, what, remedy);
}

std::vector<PathStep> split_path(const std::string& path, const std::string& option) {
  const std::string form = "write --set key.path=value or --set list[0].key=value";
  std::vector<PathStep> steps;
  std::size_t begin = 0;
  while (begin <= path.size()) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    std::string_view part = std::string_view(path).substr(begin, end - begin);
    const std::size_t bracket = part.find('[');
    const std::string_view key = part.substr(0, bracket);
    if (key.empty()) refuse(option, "has an empty key", form);
    steps.push_back({std::string(key), std::nullopt});
    part.remove_prefix(key.size());
    while (!part.empty()) {
      const std::size_t close = part.find(']');
      std::size_t index = 0;
      const char* const last = part.data() + (close == std::string_view::npos ? 0 : close);
      if (part.front() != '[' || close == std::string_view::npos ||
          std::from_chars(part.data() + 1, last, index).ptr != last || close == 1) {
        refuse(option, "has a list place that is not a number in brackets", form);
      }
      steps.push_back({"", index});
      part.remove_prefix(close + 1);
    }
    begin = end + 1;
  }
  return steps;
}

/// In the tag of a node that came from another file than its document: where it stood.
constexpr const char* kPlaceTag = "!strata-place:";

/// A copy without line numbers, by which place_of tells that it came from elsewhere: from the
/// command line, or from where tag_of says.
template <typename TagOf>
YAML::Node copy_without_marks(const YAML::Node& node, const std::string& option,
                              const TagOf& tag_of, int depth = 0) {
  if (depth > kMaxDepth) refuse(option, "is nested too deeply", "simplify the value");
  const auto inner = [&](const YAML::Node& child) {
    return copy_without_marks(child, option, tag_of, depth + 1);
  };
  YAML::Node copy;
  if (node.IsScalar()) {
    copy = YAML::Node(node.Scalar());
  } else if (node.IsSequence()) {
    copy = YAML::Node(YAML::NodeType::Sequence);
    for (const auto& item : node) copy.push_back(inner(item));
  } else if (node.IsMap()) {
    copy = YAML::Node(YAML::NodeType::Map);
    for (const auto& item : node) copy.force_insert(inner(item.first), inner(item.second));
  }
  copy.SetTag(tag_of(node));
  return copy;
}

void set_at(YAML::Node node, const std::vector<PathStep>& steps, std::size_t depth,
            const YAML::Node& value, const std::string& option) {
  const PathStep& step = steps[depth];
  const bool is_last = depth + 1 == steps.size();
  if (step.index) {
    if (!node.IsSequence() || *step.index >= node.size()) {
      refuse(option,
             "names item " + std::to_string(*step.index) + " of a list of " +
                 std::to_string(node.IsSequence() ? node.size() : 0),
             "name an item that the document has");
    }
    if (is_last) {
      node[*step.index] = value;
    } else {
      set_at(node[*step.index], steps, depth + 1, value, option);
    }
    return;
  }
  if (!node.IsMap() && !node.IsNull()) {
    refuse(option, "goes through something that is not a group of keys at '" + step.key + "'",
           "check the key path");
  }
  if (is_last) {
    node[step.key] = value;
    return;
  }
  YAML::Node child = node[step.key];
  if (!child.IsDefined() || child.IsNull()) {
    if (steps[depth + 1].index) {
      refuse(option, "names an item of a list that the document does not have",
             "give the whole list as " + step.key + "=[...]");
    }
    node[step.key] = YAML::Node(YAML::NodeType::Map);
    child.reset(node[step.key]);
  }
  set_at(child, steps, depth + 1, value, option);
}

/// Takes a document's events and does nothing with them.
class Ignoring final : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnAlias(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnScalar(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& /*value*/) override {}
  void OnSequenceStart(const YAML::Mark& /*mark*/, const std::string& /*tag*/,
                       YAML::anchor_t /*anchor*/, YAML::EmitterStyle::value /*style*/) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {}
  void OnMapEnd() override {}
};

/// Not by YAML::LoadAll: at a stray ',' the parser of yaml-cpp 0.7 ends one empty document after
/// the other without getting on, and that reads them all.
bool holds_several(const std::string& text) {
  std::istringstream in(text);
  YAML::Parser parser(in);
  Ignoring ignoring;
  return parser.HandleNextDocument(ignoring) && parser.HandleNextDocument(ignoring);
}

}  // namespace

std::string place_of(const YAML::Node& node, const std::string& place,
                     const std::string& key_path) {
  const YAML::Mark mark = node.Mark();
  if (!mark.is_null()) return place + ":" + std::to_string(mark.line + 1);
  // Only copies of ours have no mark; in a file such a tag is anybody's.
  const std::string tag = node.IsDefined() ? node.Tag() : std::string();
  if (tag.starts_with(kPlaceTag)) return tag.substr(std::string_view(kPlaceTag).size());
  // A document that was never written: there is nothing that --set could have given.
  return key_path.empty() ? place : "--set " + key_path;
}

bool has_place(const YAML::Node& node) {
  return !node.Mark().is_null() || (node.IsDefined() && node.Tag().starts_with(kPlaceTag));
}

void keep_place(YAML::Node& copy, const YAML::Node& original, const std::string& place) {
  if (has_place(original)) copy.SetTag(kPlaceTag + place_of(original, place, ""));
}

YAML::Node copy_with_places(const YAML::Node& node, const std::string& place) {
  return copy_without_marks(node, place, [&](const YAML::Node& original) {
    return kPlaceTag + place_of(original, place, "");
  });
}

YAML::Node copy_apart(const YAML::Node& node, const std::string& place) {
  return copy_without_marks(node, place, [&](const YAML::Node& original) {
    return has_place(original) ? kPlaceTag + place_of(original, place, "") : original.Tag();
  });
}

YAML::Node parse_yaml(const std::string& text, const std::string& place) {
  YAML::Node node;
  try {
    if (holds_several(text)) {
      throw ConfigError(place, "holds several YAML documents, or goes on behind the end of one",
                        "keep one document, without '---' lines and stray ',', ']' or '}'");
    }
    node = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    const std::string line = error.mark.is_null() ? "" : ":" + std::to_string(error.mark.line + 1);
    throw ConfigError(place + line, "is not YAML (" + error.msg + ")", "mend the syntax");
  }
  if (node.IsNull()) return YAML::Node(YAML::NodeType::Map);
  if (!node.IsMap()) {
    throw ConfigError(place_of(node, place, ""), "is not a map of keys",
                      "write 'key: value' lines");
  }
  return node;
}

YAML::Node parse_document(const std::string& text, const std::string& place) {
  YAML::Node document = parse_yaml(text, place);
  const YAML::Node version = document["version"];
  const std::string remedy = "write 'version: " + std::to_string(kDocumentVersion) + "'";
  if (!version.IsDefined()) throw ConfigError(place + ":1", "has no version", remedy);
  if (!version.IsScalar() || version.Scalar() != std::to_string(kDocumentVersion)) {
    const std::string found = version.IsScalar() ? " '" + version.Scalar() + "'" : "";
    throw ConfigError(place_of(version, place, "version"), "has an unknown version" + found,
                      remedy + ", or use a newer strata");
  }
  document.remove("version");
  return document;
}

YAML::Node load_document(const std::filesystem::path& file) {
  require_text_file(file);
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  if (in) text << in.rdbuf();
  // A folder opens as a stream on Linux and only then fails to give bytes.
  if (!in || in.bad() || std::filesystem::is_directory(file)) {
    throw InputError(file.string(), "cannot be read", "check that the file exists and is readable");
  }
  return parse_document(text.str(), file.string());
}

void apply_override(YAML::Node& document, const std::string& option) {
  const std::size_t equals = option.find('=');
  if (equals == std::string::npos) {
    refuse(option, "has no '='", "write --set key.path=value");
  }
  const std::vector<PathStep> steps = split_path(option.substr(0, equals), option);
  YAML::Node value;
  try {
    value = YAML::Load(option.substr(equals + 1));
  } catch (const YAML::Exception& error) {
    refuse(option, "has a value that is not YAML (" + error.msg + ")",
           "quote the value, for example key='\"text\"'");
  }
  if (equals + 1 == option.size()) value = YAML::Node("");
  if (!document.IsDefined() || document.IsNull()) document = YAML::Node(YAML::NodeType::Map);
  const auto own_tag = [](const YAML::Node& node) { return node.Tag(); };
  set_at(document, steps, 0, copy_without_marks(value, option, own_tag), option);
}

void apply_overrides(YAML::Node& document, const std::vector<std::string>& options) {
  for (const std::string& option : options) apply_override(document, option);
}

}  // namespace strata::settings
