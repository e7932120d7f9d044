// SPDX-License-Identifier: Apache-2.0
/// A message as the bytes it has on the wire and in a bag, and back.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include "core/base/error.hpp"

namespace strata::bus {

/// CDR, little endian, with its four-byte header. O(size).
template <typename T>
[[nodiscard]] std::vector<std::uint8_t> to_cdr(const T& message) {
  // + 8: room for the header and the padding after the last member.
  std::vector<std::uint8_t> bytes(T::getCdrSerializedSize(message) + 8);
  eprosima::fastcdr::FastBuffer buffer(
      reinterpret_cast<char*>(bytes.data()),  // FastBuffer wants char
      bytes.size());
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS,
                             eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  message.serialize(cdr);
  bytes.resize(cdr.getSerializedDataLength());
  return bytes;
}

/// The reverse, of either byte order. Throws InputError (place: `topic`) when the bytes end early
/// or make no sense as a T.
template <typename T>
[[nodiscard]] T from_cdr(const std::vector<std::uint8_t>& bytes, const std::string& topic) {
  // Fast CDR reads only, but its buffer type has no const form.
  auto* data = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));
  eprosima::fastcdr::FastBuffer buffer(data, bytes.size());
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::DEFAULT_ENDIAN,
                             eprosima::fastcdr::Cdr::DDS_CDR);
  T message;
  try {
    cdr.read_encapsulation();
    message.deserialize(cdr);
  } catch (const std::exception& error) {
    throw InputError(topic, std::string("a message does not decode: ") + error.what(),
                     "check that writer and reader mean the same type");
  }
  return message;
}

}  // namespace strata::bus
