// SPDX-License-Identifier: Apache-2.0
/// What most tests of core and memory read.
#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <thread>

#include "cmake/precompiled/core.hpp"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
