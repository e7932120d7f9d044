// SPDX-License-Identifier: Apache-2.0
#include "components/convert/type_hash.hpp"

#include <array>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include <openssl/evp.h>

#include "components/convert/type_description.hpp"
#include "core/base/hex_text.hpp"

namespace strata::convert {
namespace {

std::string json_of(const DescribedField& field) {
  return R"({"name": ")" + field.name + R"(", "type": {"type_id": )" +
         std::to_string(field.type_id) + R"(, "capacity": )" + std::to_string(field.capacity) +
         R"(, "string_capacity": )" + std::to_string(field.string_capacity) +
         R"(, "nested_type_name": ")" + field.nested_type + R"("}})";
}

std::string json_of(const DescribedType& type) {
  std::string json = R"({"type_name": ")" + type.name + R"(", "fields": [)";
  const char* comma = "";
  for (const DescribedField& field : type.fields) {
    json += comma + json_of(field);
    comma = ", ";
  }
  return json + "]}";
}

}  // namespace

std::string type_description(std::string_view type) {
  const std::optional<TypeDescription> description = describe_type(type);
  if (!description) return {};
  std::string json = R"({"type_description": )" + json_of(description->type) +
                     R"(, "referenced_type_descriptions": [)";
  const char* comma = "";
  for (const DescribedType& referenced : description->referenced) {
    json += comma + json_of(referenced);
    comma = ", ";
  }
  return json + "]}";
}

std::string type_hash(std::string_view type) {
  const std::string description = type_description(type);
  if (description.empty()) return {};
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (EVP_Digest(description.data(), description.size(), digest.data(), &size, EVP_sha256(),
                 nullptr) != 1) {
    throw std::runtime_error("OpenSSL has no SHA-256");
  }
  return "RIHS01_" + hex_text(std::span(digest.data(), size));
}

}  // namespace strata::convert
