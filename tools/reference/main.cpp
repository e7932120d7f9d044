// SPDX-License-Identifier: Apache-2.0
/// `strata-reference FOLDER`: writes the pages of docs/reference.
#include <exception>
#include <iostream>

#include "tools/reference/pages.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: strata-reference FOLDER, for example docs/reference\n";
    return 2;
  }
  try {
    strata::reference::write_pages(argv[1]);
  } catch (const std::exception& error) {
    std::cerr << "strata-reference: error: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
