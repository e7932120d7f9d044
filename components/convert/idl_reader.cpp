// SPDX-License-Identifier: Apache-2.0
#include "components/convert/idl_reader.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

#include "components/convert/idl_texts.hpp"

namespace strata::convert {
namespace {

/// A name with its scopes (std_msgs::msg::Header), a number or a single sign.
struct Token {
  std::string text;
  std::vector<std::string> above;  ///< comments before it, on lines of their own
  std::string behind;              ///< the comment behind it on its line
};

bool is_blank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

std::string trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return std::string(text);
}

/// Cuts a text into tokens that keep their comments; leaves preprocessor lines out.
class Scanner {
 public:
  explicit Scanner(std::string_view idl) : idl_(idl) {}

  std::vector<Token> scan() {
    while (at_ < idl_.size()) {
      if (idl_[at_] == '\n') {
        end_line();
      } else if (is_blank(idl_[at_])) {
        ++at_;
      } else if (idl_[at_] == '#') {
        at_ = line_end();
        above_.clear();
        is_empty_line_ = false;
      } else if (idl_.substr(at_, 2) == "//") {
        add_comment();
      } else {
        add_token();
      }
    }
    return std::move(tokens_);
  }

 private:
  static constexpr std::size_t kNowhere = std::string_view::npos;

  [[nodiscard]] std::size_t line_end() const { return std::min(idl_.find('\n', at_), idl_.size()); }

  void end_line() {
    if (is_empty_line_) {  // what stands above an empty line is of nothing below it
      above_.clear();
      behind_column_ = kNowhere;
    }
    line_begin_ = ++at_;
    is_empty_line_ = true;
    has_token_ = false;
  }

  void add_comment() {
    const std::size_t column = at_ - line_begin_;
    const std::string text = trimmed(idl_.substr(at_ + 2, line_end() - at_ - 2));
    if (has_token_) {
      tokens_.back().behind = text;
      behind_column_ = column;
    } else if (column == behind_column_) {  // goes on on the next line
      tokens_.back().behind += " " + text;
    } else {
      above_.push_back(text);
      behind_column_ = kNowhere;
    }
    at_ = line_end();
    is_empty_line_ = false;
  }

  void add_token() {
    const auto in_word = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == ':';
    };
    std::size_t end = at_;
    while (end < idl_.size() && in_word(idl_[end])) ++end;
    end = std::max(end, at_ + 1);
    tokens_.push_back({std::string(idl_.substr(at_, end - at_)), std::exchange(above_, {}), {}});
    at_ = end;
    is_empty_line_ = false;
    has_token_ = true;
    behind_column_ = kNowhere;
  }

  std::string_view idl_;
  std::size_t at_ = 0;
  std::size_t line_begin_ = 0;
  bool is_empty_line_ = true;
  bool has_token_ = false;                ///< on this line
  std::size_t behind_column_ = kNowhere;  ///< of a comment that the next line may go on with
  std::vector<Token> tokens_;
  std::vector<std::string> above_;
};

std::string comment_lines(const std::vector<std::string>& comments) {
  std::string text;
  for (const std::string& comment : comments) text += "# " + comment + "\n";
  return text;
}

std::string with_comment(const std::string& line, const std::string& behind) {
  return line + (behind.empty() ? "" : "  # " + behind) + "\n";
}

class IdlReader {
 public:
  IdlReader(std::string_view idl, IdlDefinitions& definitions)
      : tokens_(Scanner(idl).scan()), definitions_(definitions) {}

  void read() {
    std::vector<std::string> above;  // the annotation may stand between a comment and its struct
    while (at_ < tokens_.size()) {
      const Token& token = tokens_[at_++];
      if (!token.above.empty()) above = token.above;
      if (token.text == "@") {
        next();
        continue;
      }
      if (token.text == "module") {
        modules_.push_back(next());
        next();  // {
      } else if (token.text == "struct") {
        read_struct(above);
      } else if (token.text == "enum") {
        read_enum(above);
      } else if (token.text == "}" && !modules_.empty()) {
        modules_.pop_back();
      }
      above.clear();
    }
  }

 private:
  struct Enum {
    std::vector<std::string> above;
    std::vector<std::pair<std::string, std::string>> values;  ///< with the comment behind each
  };

  std::string next() { return at_ < tokens_.size() ? tokens_[at_++].text : std::string(); }
  bool skip(std::string_view token) {
    if (at_ >= tokens_.size() || tokens_[at_].text != token) return false;
    ++at_;
    return true;
  }
  [[nodiscard]] const std::string& behind() const {
    static const std::string none;
    return at_ > 0 ? tokens_[at_ - 1].behind : none;
  }
  /// "std_msgs/Header" of std_msgs::msg::Header, or of a name in the same module.
  [[nodiscard]] std::string message_name(const std::string& idl_name) const {
    const std::size_t first = idl_name.find("::");
    if (first == std::string::npos) return modules_.front() + "/" + idl_name;
    return idl_name.substr(0, first) + "/" + idl_name.substr(idl_name.rfind("::") + 2);
  }

  void read_enum(const std::vector<std::string>& above) {
    Enum& read = enums_[next()];
    read.above = above;
    next();  // {
    while (at_ < tokens_.size() && !skip("}")) {
      const std::string name = next();
      std::string comment = behind();
      if (skip(",") && comment.empty()) comment = behind();
      read.values.emplace_back(name, comment);
    }
  }

  /// An enum has no name in a .msg: its values are constants before the field.
  static void write_constants(const Enum& values, IdlDefinition& definition) {
    definition.commented_text += comment_lines(values.above);
    for (std::size_t i = 0; i < values.values.size(); ++i) {
      const auto& [name, comment] = values.values[i];
      const std::string line = "uint32 " + name + "=" + std::to_string(i);
      definition.text += line + "\n";
      definition.commented_text += with_comment(line, comment);
    }
  }

  std::string read_type(IdlDefinition& definition) {
    const std::string type = next();
    if (type == "sequence") {
      next();  // <
      const std::string element = read_type(definition);
      definition.layout.fields.back().is_sequence = true;
      const std::string bound = skip(",") ? "<=" + next() : std::string();
      next();  // >
      return element + "[" + bound + "]";
    }
    struct Scalar {
      const char* name;
      std::size_t size;
    };
    static const std::map<std::string, Scalar> scalars = {
        {"boolean", {"bool", 1}},  {"octet", {"byte", 1}},     {"char", {"char", 1}},
        {"int8", {"int8", 1}},     {"uint8", {"uint8", 1}},    {"int16", {"int16", 2}},
        {"uint16", {"uint16", 2}}, {"int32", {"int32", 4}},    {"uint32", {"uint32", 4}},
        {"long", {"int32", 4}},    {"int64", {"int64", 8}},    {"uint64", {"uint64", 8}},
        {"float", {"float32", 4}}, {"double", {"float64", 8}}, {"string", {"string", 0}}};
    if (const auto scalar = scalars.find(type); scalar != scalars.end()) {
      definition.layout.fields.push_back({scalar->second.size});
      return scalar->second.name;
    }
    if (const auto values = enums_.find(type); values != enums_.end()) {
      write_constants(values->second, definition);
      definition.layout.fields.push_back({4});
      return "uint32";
    }
    definition.uses.push_back(message_name(type));
    definition.layout.fields.push_back({0, &definitions_[definition.uses.back()].layout});
    return definition.uses.back();
  }

  void read_struct(const std::vector<std::string>& above) {
    IdlDefinition& definition = definitions_[message_name(next())];
    definition.kind = modules_.size() > 1 ? modules_[1] : "";
    if (!above.empty()) definition.commented_text = comment_lines(above) + "\n";
    next();  // {
    while (at_ < tokens_.size() && !skip("}")) {
      const std::string comments = comment_lines(tokens_[at_].above);
      std::string type = read_type(definition);
      const std::string field = next();
      if (skip("[")) {
        const std::string count = next();
        definition.layout.fields.back().count = std::stoul(count);
        type += "[" + count + "]";
        next();  // ]
      }
      next();  // ;
      const std::string line = type + " " + field;
      definition.text += line + "\n";
      definition.commented_text += comments + with_comment(line, behind());
    }
  }

  std::vector<Token> tokens_;
  std::size_t at_ = 0;
  IdlDefinitions& definitions_;
  std::vector<std::string> modules_;
  std::map<std::string, Enum> enums_;
};

}  // namespace

void read_idl(std::string_view idl, IdlDefinitions& definitions) {
  IdlReader(idl, definitions).read();
}

const IdlDefinitions& idl_definitions() {
  static const IdlDefinitions all = [] {
    IdlDefinitions made;
    for (const std::string_view idl : idl_texts()) read_idl(idl, made);
    return made;
  }();
  return all;
}

}  // namespace strata::convert
