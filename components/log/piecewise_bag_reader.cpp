// SPDX-License-Identifier: Apache-2.0
#include "components/log/piecewise_bag_reader.hpp"

#include <utility>

#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {

PiecewiseBagReader::PiecewiseBagReader(const fs::path& file, const fs::path& shown)
    : name_(shown.string()), in_(file, std::ios::binary) {
  if (!in_) throw InputError(name_, "cannot be opened", "check its permissions");
  size_ = fs::file_size(file);
}

void PiecewiseBagReader::start() {
  find_pieces();
  messages_.set_pieces(std::move(pieces_));
  messages_.prefetch([this](const BagPiece& piece) { load(piece); });
  if (topics().empty() && damage_.count > 0) {
    const std::string& first = damage_.first;  // begins with the name
    const std::string why =
        first.starts_with(name_ + ": ") ? first.substr(name_.size() + 2) : first;
    throw InputError(name_, why, "check that it was copied whole");
  }
}

bool PiecewiseBagReader::next(BagMessage& message) {
  return messages_.next(message, [this](const BagPiece& piece) { load(piece); });
}

Bytes PiecewiseBagReader::read(std::uint64_t offset, std::uint64_t size) {
  Bytes bytes(static_cast<std::size_t>(size));
  in_.clear();
  in_.seekg(static_cast<std::streamoff>(offset));
  in_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(in_.gcount()));
  return bytes;
}

}  // namespace strata::log
