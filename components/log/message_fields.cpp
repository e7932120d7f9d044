// SPDX-License-Identifier: Apache-2.0
#include "components/log/message_fields.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <map>
#include <sstream>
#include <string_view>
#include <utility>

#include "components/convert/message_definitions.hpp"
#include "core/base/error.hpp"

namespace strata::log {
namespace {

/// One line of a .msg file.
struct Member {
  std::string type;  ///< without its array part
  std::string name;
  enum { kSingle, kFixed, kSequence } shape = kSingle;
  std::size_t count = 1;  ///< of a fixed array
};
using Types = std::map<std::string, std::vector<Member>>;

/// "float64[36] covariance"; nothing for comments, constants and empty lines.
std::optional<Member> parse_member(const std::string& line) {
  std::istringstream words(line.substr(0, line.find('#')));
  Member member;
  if (!(words >> member.type >> member.name) || member.name.find('=') != std::string::npos) {
    return std::nullopt;
  }
  if (std::string rest; words >> rest && rest.starts_with('=')) return std::nullopt;
  const std::size_t bracket = member.type.find('[');
  if (bracket == std::string::npos) return member;
  const std::string size = member.type.substr(bracket + 1, member.type.size() - bracket - 2);
  member.type.erase(bracket);
  member.shape = size.empty() || size.front() == '<' ? Member::kSequence : Member::kFixed;
  if (member.shape == Member::kFixed) member.count = std::stoul(size);
  return member;
}

/// A definition as MCAP keeps it, the type's own text first.
Types parse_types(const std::string& own_name, const std::string& definition) {
  Types types;
  std::string current = own_name;
  std::istringstream lines(definition);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("====")) continue;
    if (line.starts_with("MSG: ")) {
      current = line.substr(5);
      continue;
    }
    if (auto member = parse_member(line)) types[current].push_back(std::move(*member));
  }
  return types;
}

std::string short_name(std::string type) {
  if (const auto at = type.find("/msg/"); at != std::string::npos) type.erase(at, 4);
  return type;
}

/// Reads CDR by the types; collects values, or only counts up to one whose path is wanted.
class Walker {
 public:
  Walker(const Types& types, std::span<const std::uint8_t> cdr) : types_(types), bytes_(cdr) {
    if (cdr.size() < 4) fail();
    swap_ = (cdr[1] == 1) != (std::endian::native == std::endian::little);
  }

  std::vector<FieldValue> values(const std::string& type) {
    walk(type, "");
    return std::move(values_);
  }
  std::string path(const std::string& type, std::size_t index) {
    wanted_ = index;
    walk(type, "");
    return std::move(path_);
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  [[noreturn]] static void fail() {
    throw InputError("message", "its bytes do not fit its type", "check the recorder's version");
  }

  void walk(const std::string& type, const std::string& path) {
    const auto found = types_.find(type);
    if (found == types_.end()) fail();
    for (const Member& member : found->second) {
      const std::string own = wanted_ == kNone ? ""
                              : path.empty()   ? member.name
                                               : path + "." + member.name;
      std::size_t count = member.count;
      if (member.shape == Member::kSequence) {
        count = number<std::uint32_t>();
        if (count > bytes_.size()) fail();
        add({static_cast<double>(count), {}, false}, own + ".length");
      }
      for (std::size_t i = 0; i < count; ++i) {
        value(member.type, member.shape == Member::kSingle || wanted_ == kNone
                               ? own
                               : own + "[" + std::to_string(i) + "]");
      }
    }
  }

  void value(const std::string& type, const std::string& path) {
    if (type == "string") {
      const std::size_t size = number<std::uint32_t>();
      if (at_ + size > bytes_.size() || size == 0) fail();
      const auto* begin = reinterpret_cast<const char*>(bytes_.data() + at_);
      add({0.0, std::string(begin, size - 1), true}, path);
      at_ += size;
    } else if (type == "float64") {
      add(number<double>(), path);
    } else if (type == "float32") {
      add(static_cast<double>(number<float>()), path);
    } else if (type == "int8") {
      add(number<std::int8_t>(), path);
    } else if (type == "uint8" || type == "byte" || type == "char" || type == "bool") {
      add(number<std::uint8_t>(), path);
    } else if (type == "int16") {
      add(number<std::int16_t>(), path);
    } else if (type == "uint16") {
      add(number<std::uint16_t>(), path);
    } else if (type == "int32") {
      add(number<std::int32_t>(), path);
    } else if (type == "uint32") {
      add(number<std::uint32_t>(), path);
    } else if (type == "int64") {
      add(static_cast<double>(number<std::int64_t>()), path);
    } else if (type == "uint64") {
      add(static_cast<double>(number<std::uint64_t>()), path);
    } else {
      walk(type, path);
    }
  }

  void add(double number, const std::string& path) { add(FieldValue{number, {}, false}, path); }
  void add(FieldValue value, const std::string& path) {
    if (wanted_ == kNone) {
      values_.push_back(std::move(value));
    } else if (seen_++ == wanted_) {
      path_ = path;
    }
  }

  template <typename T>
  T number() {
    const std::size_t offset = at_ - 4;  // alignment counts from behind the header
    at_ += (sizeof(T) - offset % sizeof(T)) % sizeof(T);
    if (at_ + sizeof(T) > bytes_.size()) fail();
    std::array<std::uint8_t, sizeof(T)> raw;
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(at_), sizeof(T), raw.begin());
    if (swap_) std::reverse(raw.begin(), raw.end());
    at_ += sizeof(T);
    return std::bit_cast<T>(raw);
  }

  const Types& types_;
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 4;
  bool swap_ = false;
  std::vector<FieldValue> values_;
  std::size_t wanted_ = kNone;
  std::size_t seen_ = 0;
  std::string path_;
};

}  // namespace

std::optional<std::vector<FieldValue>> message_fields(const std::string& type,
                                                      std::span<const std::uint8_t> cdr) {
  const std::string definition = convert::message_definition(type);
  if (definition.empty()) return std::nullopt;
  const Types types = parse_types(short_name(type), definition);
  return Walker(types, cdr).values(short_name(type));
}

std::string field_path(const std::string& type, std::span<const std::uint8_t> cdr,
                       std::size_t index) {
  const std::string definition = convert::message_definition(type);
  if (definition.empty()) return {};
  const Types types = parse_types(short_name(type), definition);
  return Walker(types, cdr).path(short_name(type), index);
}

}  // namespace strata::log
