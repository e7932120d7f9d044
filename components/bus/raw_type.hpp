// SPDX-License-Identifier: Apache-2.0
/// Any message as its CDR bytes, under the type name that ROS 2 gives it. Matching goes by that
/// name, so one class serves every topic; for the bus's own .cpp files only.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <new>
#include <string>
#include <vector>

#include <fastdds/dds/topic/TopicDataType.hpp>

namespace strata::bus {

class RawType : public eprosima::fastdds::dds::TopicDataType {
 public:
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;
  using Bytes = std::vector<std::uint8_t>;

  explicit RawType(const std::string& type_name) {
    setName(type_name.c_str());
    m_typeSize = 256;  // where the pool starts; it grows as messages need
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }

  bool serialize(void* data, Payload* payload) override {
    const Bytes& bytes = *static_cast<const Bytes*>(data);
    if (bytes.size() < 4 || bytes.size() > payload->max_size) return false;
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = bytes[1] == 0 ? CDR_BE : CDR_LE;
    return true;
  }
  bool deserialize(Payload* payload, void* data) override {
    try {
      static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    } catch (const std::bad_alloc&) {  // the middleware is not made for exceptions
      return false;
    }
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    const auto size = static_cast<std::uint32_t>(static_cast<const Bytes*>(data)->size());
    return [size] { return size; };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void* /*data*/, eprosima::fastrtps::rtps::InstanceHandle_t* /*handle*/,
              bool /*force_md5*/) override {
    return false;
  }
};

}  // namespace strata::bus
