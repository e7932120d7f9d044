// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/fuzz_target.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace fs = std::filesystem;

namespace strata::fuzz {

ScratchFolder::ScratchFolder() {
  const fs::path base = fs::exists("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
  std::string pattern = (base / "strata-fuzz-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no scratch folder");
  path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

fs::path ScratchFolder::write(const std::string& name, Input bytes) const {
  fs::path file = path_ / name;
  for (const char* part : {"-wal", "-shm"}) fs::remove(file.string() + part);  // of the one before
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
  return file;
}

std::pair<Input, Input> split(Input input) {
  constexpr std::string_view mark = "\n=====\n";
  const auto at = std::search(input.begin(), input.end(), mark.begin(), mark.end());
  const auto first = static_cast<std::size_t>(at - input.begin());
  if (at == input.end()) return {input, {}};
  return {input.first(first), input.subspan(first + mark.size())};
}

}  // namespace strata::fuzz
