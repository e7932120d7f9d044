// SPDX-License-Identifier: Apache-2.0
/// Messages as the bytes that travel in DDS and lie in bags: XCDR1 with a header of 4 bytes.
#pragma once

#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <span>
#include <string>
#include <vector>

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include "components/convert/cdr_check.hpp"
#include "core/base/error.hpp"

namespace strata::convert {

/// Bytes that are not a message of their type.
class Undecodable : public InputError {
 public:
  using InputError::InputError;
};

/// Little-endian CDR of a generated message.
template <typename Message>
[[nodiscard]] std::vector<std::uint8_t> to_cdr(const Message& message) {
  std::vector<std::uint8_t> bytes(Message::getCdrSerializedSize(message) + 4);
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(bytes.data()), bytes.size());
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS,
                             eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  message.serialize(cdr);
  bytes.resize(cdr.getSerializedDataLength());
  return bytes;
}

/// The message. Throws Undecodable(place, ...) when the bytes are not one; sequences longer than
/// the bytes are refused before memory is taken for them. Throws std::bad_alloc.
template <typename Message>
[[nodiscard]] Message from_cdr(std::span<const std::uint8_t> bytes, const std::string& place) {
  const auto damaged = [&](const std::string& why) {
    return Undecodable(place, "is not a valid message: " + why, "record it again or leave it out");
  };
  if (bytes.size() < 4) throw damaged("shorter than its header");
  if (bytes[0] != 0 || bytes[1] > 1) throw damaged("is not plain CDR");
  if (!sequences_fit<Message>(bytes)) throw damaged("announces more content than it has");
  // FastBuffer wants a mutable pointer, but reading leaves the bytes alone.
  auto* data = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));
  eprosima::fastcdr::FastBuffer buffer(data, bytes.size());
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS,
                             eprosima::fastcdr::Cdr::DDS_CDR);
  Message message;
  try {
    cdr.read_encapsulation();
    message.deserialize(cdr);
  } catch (const std::bad_alloc&) {
    throw;  // no fault of the message
  } catch (const std::exception& error) {
    throw damaged(error.what());
  }
  return message;
}

}  // namespace strata::convert
